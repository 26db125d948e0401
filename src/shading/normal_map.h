// Normals bent by a picture.
#pragma once

#include <array>

#include <kairos/mesh.h>
#include <kairos/vec.h>

namespace kairos {

/// Two unit vectors along a surface: in which the normal picture's u rises, and up the picture. Zero where it has no
/// direction there.
struct TangentFrame {
  Vec3d right, up;
};

/// From Mesh::tangents at a point, `tangent` taken to the space of the normal: `normal` is unit, on the side from which
/// the vertices run counter-clockwise.
TangentFrame tangent_frame(Vec3d tangent, float sign, Vec3d normal);

/// From how the picture lies on one triangle, for a mesh without tangents.
TangentFrame tangent_frame(const std::array<Vec3d, 3>& vertices, const std::array<Vec2f, 3>& uvs, Vec3d normal);

/// The mesh's own tangent, interpolated over time and over the triangle, and its sign; zero when they cancel.
Vec4f interpolated_tangent(const Mesh& mesh, uint32_t triangle, const std::array<float, 3>& weights, float time);

/// The normal that the picture asks for. bend: what it says, along the frame and the normal; of any length. seen: the
/// surface is seen from the normal's side (1) or from the other (-1), on which everything is turned round, as glTF
/// asks. The result is on the viewer's side, unit, and never turned away from the viewer: where the picture says so, it
/// is turned back until the surface is just seen.
Vec3d mapped_normal(Vec3f bend, const TangentFrame& frame, Vec3d normal, double seen, Vec3d to_viewer);

}  // namespace kairos
