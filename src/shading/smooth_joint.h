// Where shading goes on smoothly from one triangle of a mesh to the next.
#pragma once

#include <kairos/mesh.h>

namespace kairos {

/// What the colour depends on, and so must not jump between two triangles.
struct JointNeeds {
  bool normals = true;  ///< the mesh's own at the common corner, or those of the triangles
  bool looks = true;    ///< texture coordinates and colour at the common corner
};

/// True when the triangles have a corner in common (a vertex, or two of them in the same place) at which nothing that
/// is needed jumps: normals within 30 degrees of each other, and the same texture coordinates and colour. time: shutter
/// time near which they are looked at. A few nanoseconds; no tables.
bool smooth_joint(const Mesh& mesh, uint32_t a, uint32_t b, float time, const JointNeeds& needs);

}  // namespace kairos
