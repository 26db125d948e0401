// What OBJ and PLY files hold, and one or more of them put together as the motion keys of a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <kairos/mesh.h>

namespace kairos {

constexpr uint32_t kNoIndex = 0xffffffff;     ///< a corner without a normal or texture coordinate
constexpr uint32_t kBadIndex = 0xfffffffe;    ///< an index that names nothing
constexpr uint64_t kMaxIndices = 0xfffffff0;  ///< how many vertices or corners a mesh may have

/// Polygons as a file has them. Corners may refer to positions, normals and texture coordinates apart, as in OBJ.
struct PolygonMesh {
  std::string path;  ///< for messages
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  std::vector<uint32_t> corners;     ///< face after face: index into positions, or not (any value)
  std::vector<uint32_t> face_sizes;  ///< corners of each face; empty: all are triangles
  /// [corner] index into normals and uvs, or kNoIndex. Empty: `normals` (`uvs`) is empty or holds one per position.
  std::vector<uint32_t> corner_normals, corner_uvs;
  std::vector<Vec4f> colors;                ///< empty, or one per position; linear, with alpha, each 0 to 1
  std::vector<uint32_t> face_materials;     ///< [face] index into material_names; empty: all have the first
  std::vector<std::string> material_names;  ///< as the file calls them; empty: it says nothing of materials
  std::vector<std::string> libraries;       ///< file names, as written, of what defines these materials
  std::vector<std::string> warnings;        ///< one line each

  /// Ends a face whose `size` corners were just appended. Throws Error(bad_input) when there are too many in all.
  void end_face(uint64_t size, uint32_t material = 0);
};

/// Triangles over vertices at one or more motion keys.
struct MeshData {
  std::vector<Triangle> triangles;
  std::vector<uint32_t> prim_ids;             ///< empty, or [triangle]: its number before others were dropped
  std::vector<std::vector<Vec3f>> positions;  ///< [key][vertex]; may not be finite where no triangle refers to it
  std::vector<std::vector<Vec3f>> normals;   ///< empty, or [key][vertex]; unit, or zero where the file has no direction
  std::vector<Vec2f> uvs;                    ///< empty, or [vertex]; (0, 0) where the file has none
  std::vector<Vec4f> colors;                 ///< empty, or [vertex]; linear, with alpha
  std::vector<uint32_t> triangle_materials;  ///< [triangle] index into material_names; empty: all have the first
  std::vector<std::string> material_names, libraries;  ///< see PolygonMesh
  std::vector<std::string> warnings;                   ///< one line each
};

/// A colour as OBJ and PLY files have it, in codes of sRGB from 0 to 1, as Mesh::colors has it. What is no number is 1.
Vec4f color_of_codes(Vec4f codes);

/// OBJ and PLY count v from a picture's lower edge; here it is counted from the upper one.
std::vector<Vec2f> uvs_from_above(std::vector<Vec2f> uvs);

/// Cuts polygons into triangles (a polygon of n corners counts as n - 2, in the file's order, cut as the first key has
/// it), splits vertices whose corners differ in normal or texture coordinate (the first use keeps the vertex's place,
/// others follow the file's last vertex in order of use), and drops triangles with a bad index of a vertex or, at any
/// key, a vertex that is not finite; a bad index of a normal or texture coordinate is none. Normals are kept when every
/// corner of every key has one; texture coordinates, colours and materials are the first key's. Throws Error(bad_input)
/// when the keys' faces differ, when there are more than 2^32 corners or vertices, and, with `strict`, in place of the
/// first warning.
MeshData make_mesh_data(std::vector<PolygonMesh> keys, bool strict);

}  // namespace kairos
