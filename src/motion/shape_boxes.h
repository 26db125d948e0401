// A shape's extent in a few boxes.
#pragma once

#include <array>
#include <vector>

#include <kairos/mesh.h>

namespace kairos {

using BoxCorners = std::array<Vec3f, 8>;

/// Boxes that together hold all triangles of a mesh at its first key, each about as many triangles that lie near each
/// other: 128, or as many more as 256 boxes ask for.
std::vector<BoxCorners> shape_boxes(const Mesh& mesh);

}  // namespace kairos
