// Triangle meshes whose vertices move linearly between motion keys: what the kernels trace.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <kairos/affine_map.h>
#include <kairos/export.h>
#include <kairos/vec.h>

namespace kairos {

using Triangle = std::array<uint32_t, 3>;  ///< vertex indices, counter-clockwise seen from the front

/// What takes an object's directions to the world, as rows of two matrices. What comes out is made unit length.
struct DirectionMap {
  std::array<Vec3f, 3> normal, tangent;
  float handedness = 1;  ///< 1, or -1 where tangents change theirs: see Mesh::tangents
};

/// One mesh during one opening of the shutter.
///
/// A mesh is made of vertices of its own, or it is an *instance*: another mesh, its object, that affine maps place at
/// each key. Between keys a vertex goes straight from one place to the other, as it would if the instance were a mesh
/// of its own; what is seen, and when, is the same.
///
/// Invariants (validate_mesh checks them): every index is below vertex_count(); all keys have the same number of
/// vertices; all positions are finite. With one key the mesh is static and key_times is ignored; with more, key_times
/// ascends from 0 (shutter opens) to 1 (shutter closes), and vertices move linearly between neighbouring keys. Two
/// neighbours with equal times are a jump: the mesh is at the first one before that instant and at the second one from
/// it on. The same holds for an instance's placements in place of positions.
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

  /// Null, or what this is an instance of: a mesh with one key that is no instance itself. Then all above that has a
  /// number per vertex or triangle is the object's, and empty here.
  std::shared_ptr<const Mesh> object;
  std::vector<AffineMap> placements;     ///< of an instance: [key]
  std::vector<DirectionMap> directions;  ///< of one whose object has normals or tangents: [1 or key]

  /// Of which the triangles, and all that vertices have but their places, are.
  const Mesh& shape() const { return object ? *object : *this; }
  size_t key_count() const { return object ? placements.size() : positions.size(); }
  size_t vertex_count() const { return shape().positions.empty() ? 0 : shape().positions.front().size(); }
  size_t triangle_count() const { return shape().triangles.size(); }
  const Triangle& triangle(size_t index) const { return shape().triangles[index]; }
  Vec3f position(size_t key, uint32_t vertex) const {
    return object ? placements[key].point(object->positions.front()[vertex]) : positions[key][vertex];
  }
  /// Of normals: 0, 1, or key_count().
  size_t normal_key_count() const { return !object ? normals.size() : object->normals.empty() ? 0 : directions.size(); }
  Vec3f normal(size_t key, uint32_t vertex) const {
    return object ? placed(directions[key].normal, object->normals.front()[vertex]) : normals[key][vertex];
  }
  /// Of tangents: 0, 1, or key_count().
  size_t tangent_key_count() const {
    return !object ? tangents.size() : object->tangents.empty() ? 0 : directions.size();
  }
  Vec4f tangent(size_t key, uint32_t vertex) const {
    if (!object) return tangents[key][vertex];
    const Vec4f& own = object->tangents.front()[vertex];
    const Vec3f along = placed(directions[key].tangent, {own.x, own.y, own.z});
    return {along.x, along.y, along.z, own.w * directions[key].handedness};
  }
  /// [vertex], or empty for a set that is not there.
  const std::vector<Vec2f>& uv_set(uint32_t set) const {
    static const std::vector<Vec2f> none;
    const Mesh& from = shape();
    return set == 0 ? from.uvs : set <= from.more_uvs.size() ? from.more_uvs[set - 1] : none;
  }
  bool is_static() const { return key_count() < 2; }
  uint32_t prim_id(uint32_t triangle) const {
    const Mesh& from = shape();
    return from.prim_ids.empty() ? triangle : from.prim_ids[triangle];
  }

 private:
  static Vec3f placed(const std::array<Vec3f, 3>& rows, Vec3f direction) {
    return normalize(Vec3f{dot(rows[0], direction), dot(rows[1], direction), dot(rows[2], direction)});
  }
};

/// The mesh with vertices of its own: an instance's are where it places them, bit for bit.
KAIROS_API Mesh expanded(const Mesh& mesh);

/// Throws Error(bad_input) that names the first broken invariant.
KAIROS_API void validate_mesh(const Mesh& mesh);

}  // namespace kairos
