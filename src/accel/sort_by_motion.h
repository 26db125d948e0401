// Which triangles move, and which stand still: those of moving meshes may do either.
#pragma once

#include <span>

#include <kairos/scene.h>

#include "accel/builder.h"
#include "base/large_array.h"

namespace kairos {

using TriangleList = LargeArray<TriangleId>;

struct Sorted {
  TriangleList still, moving;
};

/// Sorts triangles into lists, in which they keep their order; those of meshes that stand still are left out where only
/// moving meshes are asked for.
Sorted sort_by_motion(std::span<const Mesh> meshes, bool moving_meshes_only);

}  // namespace kairos
