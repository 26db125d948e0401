// Triangle meshes whose vertices move linearly between motion keys: what the kernels trace.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/vec.h>

namespace kairos {

using Triangle = std::array<uint32_t, 3>;  ///< vertex indices, counter-clockwise seen from the front

/// One mesh during one opening of the shutter.
///
/// Invariants (validate_mesh checks them): every index is below vertex_count(); all keys have the same number of
/// vertices; all positions are finite. With one key the mesh is static and key_times is ignored; with more, key_times
/// ascends from 0 (shutter opens) to 1 (shutter closes), and vertices move linearly between neighbouring keys. Two
/// neighbours with equal times are a jump: the mesh is at the first one before that instant and at the second one from
/// it on.
struct Mesh {
  std::string name;
  std::vector<Triangle> triangles;
  std::vector<float> key_times;               ///< [key], shutter time
  std::vector<std::vector<Vec3f>> positions;  ///< [key][vertex]
  std::vector<std::vector<Vec3f>> normals;    ///< empty, or [1 or key][vertex]; unit, world space
  /// Empty, or [1 or key][vertex]: x, y, z: unit, world space, the way in which u of the material's normal picture
  /// rises; w: 1 or -1, the sign of cross(normal, tangent) that points to the picture's upper edge.
  std::vector<std::vector<Vec4f>> tangents;
  std::vector<Vec2f> uvs;                    ///< empty, or [vertex]; (0, 0) is a picture's upper left corner
  std::vector<std::vector<Vec2f>> more_uvs;  ///< sets 1, 2, ... of the same kind, each empty or [vertex]
  std::vector<Vec4f> colors;                 ///< empty, or [vertex]: linear red, green, blue and alpha, finite
  std::vector<uint32_t> prim_ids;  ///< empty, or [triangle]: its number in the source, where some were dropped
  uint32_t material = 0;
  bool one_sided = false;  ///< a triangle is there only while the side seen along a ray is its front

  size_t key_count() const { return positions.size(); }
  size_t vertex_count() const { return positions.empty() ? 0 : positions.front().size(); }
  /// [vertex], or empty for a set that is not there.
  const std::vector<Vec2f>& uv_set(uint32_t set) const {
    static const std::vector<Vec2f> none;
    return set == 0 ? uvs : set <= more_uvs.size() ? more_uvs[set - 1] : none;
  }
  bool is_static() const { return positions.size() < 2; }
  uint32_t prim_id(uint32_t triangle) const { return prim_ids.empty() ? triangle : prim_ids[triangle]; }
};

/// Throws Error(bad_input) that names the first broken invariant.
KAIROS_API void validate_mesh(const Mesh& mesh);

}  // namespace kairos
