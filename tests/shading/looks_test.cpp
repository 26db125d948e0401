// What a surface looks like at a point: its pictures, each in its own place, and the colours of its vertices.
#include "shading/looks.h"

#include <gtest/gtest.h>

#include "image/texture.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

/// 2 x 1 pixels, of this red on the left and on the right.
std::shared_ptr<const Texture> halves(float left, float right) {
  Pixels pixels{2, 1, {}, {left, 1, 1, 1, right, 1, 1, 1}};
  return std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::linear);
}

/// A triangle that lies all in the left half of a picture by one set of coordinates, and in the right by another.
Shot two_sets() {
  Shot shot;
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.positions = {{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}};
  mesh.uvs.assign(3, {0.25f, 0.5f});
  mesh.more_uvs = {{}, std::vector<Vec2f>(3, {0.75f, 0.5f})};
  shot.meshes = {mesh};
  shot.materials = {lambert({1, 1, 1})};
  shot.materials[0].emission = {1, 1, 1};
  shot.textures = {{halves(0.25f, 0.5f), halves(2, 4), nullptr}};
  return shot;
}

Look look_of(const Shot& shot, const std::array<float, 3>& weights = {0.5f, 0.25f, 0.25f}) {
  std::array<Vec3d, 3> corners;
  for (size_t i = 0; i < 3; ++i) corners[i] = to_double(shot.meshes[0].positions[0][i]);
  return Looks(shot).at(0, 0, corners, weights, 0);
}

TEST(Looks, EachPictureTakesItsOwnCoordinates) {
  Shot shot = two_sets();
  EXPECT_EQ(look_of(shot).base_colour.x, 0.25f);
  EXPECT_EQ(look_of(shot).emission.x, 2);
  shot.materials[0].emission_texture.uv_set = 2;
  EXPECT_EQ(look_of(shot).base_colour.x, 0.25f);
  EXPECT_EQ(look_of(shot).emission.x, 4);
  shot.materials[0].emission_texture.uv_set = 1;
  EXPECT_EQ(look_of(shot).emission.x, 1) << "a set that the mesh lacks: no picture";
  shot.materials[0].emission_texture.uv_set = 7;
  EXPECT_EQ(look_of(shot).emission.x, 1);
}

TEST(Looks, EachPictureHasItsOwnPlaceAndEdges) {
  Shot shot = two_sets();
  TextureRef& base = shot.materials[0].base_color_texture;
  base.placement = {Vec3f{1, 0, 0.5f}, Vec3f{0, 1, 0}};
  EXPECT_EQ(look_of(shot).base_colour.x, 0.5f);
  EXPECT_EQ(look_of(shot).emission.x, 2);
  base.placement[0].z = 1;
  EXPECT_EQ(look_of(shot).base_colour.x, 0.25f) << "repeats";
  base.wrap = {TextureWrap::clamp, TextureWrap::clamp};
  EXPECT_EQ(look_of(shot).base_colour.x, 0.5f);
  base.placement = {Vec3f{0, 1, 0.25f}, Vec3f{1, 0, 0}};
  EXPECT_EQ(look_of(shot).base_colour.x, 0.5f) << "u from v";
}

TEST(Looks, ColoursOfVerticesMultiplyBaseColourAndAlphaAndNothingElse) {
  Shot shot = two_sets();
  shot.materials[0].alpha = 0.5f;
  shot.meshes[0].colors = {{1, 0, 0.5f, 1}, {0, 1, 0.5f, 0.5f}, {0, 0, 0.5f, 0.25f}};
  const Look look = look_of(shot);
  EXPECT_FLOAT_EQ(look.base_colour.x, 0.25f * 0.5f);
  EXPECT_FLOAT_EQ(look.base_colour.y, 0.25f);
  EXPECT_EQ(look.base_colour.z, 0.5f) << "what is even stays so, to the bit";
  EXPECT_FLOAT_EQ(look.alpha, 0.5f * (0.5f + 0.125f + 0.0625f));
  EXPECT_EQ(look.emission, (Vec3f{2, 1, 1}));
  const Looks looks(shot);
  EXPECT_TRUE(looks.varies(0));
  EXPECT_TRUE(looks.has_vertex_alpha(0));
  shot.textures.clear();
  EXPECT_TRUE(Looks(shot).varies(0)) << "without pictures, too";
  for (Vec4f& colour : shot.meshes[0].colors) colour.w = 1;
  EXPECT_FALSE(Looks(shot).alpha_varies(0));
}

}  // namespace
}  // namespace kairos
