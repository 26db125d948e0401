// One primitive of a glTF mesh as plain arrays: what all of its instances share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <kairos/mesh.h>
#include <kairos/scene.h>

#include "scene/motion.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

struct MorphTarget {
  std::vector<Vec3f> positions, normals, tangents;  ///< displacements: empty, or one per vertex
};

struct Influence {
  uint32_t joint;  ///< index into the skin's joints
  float weight;    ///< those of a vertex sum to 1
};

struct Primitive {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< empty, or one per vertex; not zero
  /// Empty, or one per vertex: see Mesh::tangents. Only where the material has a normal picture.
  std::vector<Vec4f> tangents;
  std::vector<Vec2f> uvs;                    ///< empty, or one per vertex
  std::vector<std::vector<Vec2f>> more_uvs;  ///< see Mesh::more_uvs: those that the material's pictures take
  std::vector<Vec4f> colors;                 ///< empty, or one per vertex
  std::vector<MorphTarget> targets;
  std::vector<uint32_t> influence_begin;  ///< empty, or one per vertex and the end: ranges in `influences`
  std::vector<Influence> influences;
  uint32_t joint_count = 0;  ///< how many joints a skin must have at least

  std::vector<Triangle> triangles;  ///< indices below the number of vertices
  std::vector<uint32_t> prim_ids;   ///< as Mesh::prim_ids
  uint32_t material = 0;            ///< index into the scene's materials

  bool is_skinned() const { return !influence_begin.empty(); }
  VertexShape shape() const { return {positions, normals, tangents}; }
};

/// Null for a primitive of points or lines, or without positions (with a warning). Triangles that name vertices that
/// do not exist are dropped with a warning. materials: as read_materials leaves them. Throws Error for what cannot be
/// used.
std::shared_ptr<const Primitive> read_primitive(Document& document, const file::Primitive& source,
                                                const std::vector<Material>& materials, const std::string& where,
                                                Warnings& warnings);

/// Triangles of a list, strip or fan (glTF's modes 4, 5, 6) of `corners`; the first one's orientation is all one's.
std::vector<Triangle> assemble_triangles(const std::vector<uint32_t>& corners, int mode);

}  // namespace kairos::gltf
