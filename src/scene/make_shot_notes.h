// What the log and `info` say about how a shot was made.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <kairos/mesh.h>

#include "scene/clean_triangles.h"

namespace kairos {

/// What became of one mesh.
struct MeshReport {
  double excess = 0;  ///< see MotionKeys::excess
  DroppedTriangles dropped;
};

/// One line for the keys of all meshes, one for those that needed too many, one for the triangles dropped; a line is
/// left out where there is nothing to say.
std::vector<std::string> shot_notes(std::span<const Mesh> meshes, std::span<const MeshReport> reports);

}  // namespace kairos
