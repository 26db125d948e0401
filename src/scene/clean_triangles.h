// Leaves out triangles that nothing can be traced against.
#pragma once

#include <cstddef>

#include <kairos/mesh.h>

namespace kairos {

struct DroppedTriangles {
  size_t not_finite = 0;  ///< a vertex is NaN or infinite at some key, or does not exist
  size_t zero_area = 0;   ///< at every time

  size_t total() const { return not_finite + zero_area; }
};

/// Removes such triangles from `mesh`, whose prim_ids keep the others' numbers, and moves positions that are not finite
/// to the origin at every key (no triangle uses them any more). Normals that are not finite become zero vectors.
DroppedTriangles clean_triangles(Mesh& mesh);

}  // namespace kairos
