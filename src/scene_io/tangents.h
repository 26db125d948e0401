// Tangents of a mesh whose file has none, by the rules of MikkTSpace, which glTF names.
#pragma once

#include <span>
#include <vector>

#include <kairos/mesh.h>

namespace kairos {

inline constexpr uint32_t kNoTangent = 0xffffffff;

struct CornerTangents {
  std::vector<Vec4f> tangents;   ///< as Mesh::tangents has them
  std::vector<uint32_t> corner;  ///< [3 * triangle + corner]: index into `tangents`, or kNoTangent
};

/// M. S. Mikkelsen, Simulation of Wrinkled Surfaces Revisited (2008), chapter 2, with the choices of his published
/// implementation: vertices of equal position, normal and texture coordinates are one; around a vertex, triangles that
/// hang together by their edges and show the picture the same way round (mirrored or not) share a tangent; it is the
/// mean of theirs along the vertex's tangent plane, weighed by their angles at the vertex.
///
/// positions, normals, uvs: one per vertex, uvs with v downwards, as Mesh::uvs; triangles: indices of existing
/// vertices. O(n log n). Triangles that cover nothing of the picture take what their neighbours have.
CornerTangents make_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                             std::span<const Vec2f> uvs, std::span<const Triangle> triangles);

}  // namespace kairos
