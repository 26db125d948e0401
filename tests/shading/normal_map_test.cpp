// Normals bent by a picture, in tangent space as glTF has it.
#include "shading/normal_map.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "image/texture.h"
#include "seed.h"
#include "shading/shader.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

void expect_near(Vec3d actual, Vec3d expected, const char* what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], 1e-6) << what << ", component " << c;
}

// u to the right, v down the picture: what faces the viewer upright.
constexpr std::array<Vec3d, 3> kCorners{Vec3d{0, 0, 0}, Vec3d{2, 0, 0}, Vec3d{0, 2, 0}};
constexpr std::array<Vec2f, 3> kUpright{Vec2f{0, 1}, Vec2f{1, 1}, Vec2f{0, 0}};

TEST(NormalMap, TheFrameFollowsThePicture) {
  const Vec3d normal{0, 0, 1};
  const TangentFrame upright = tangent_frame(kCorners, kUpright, normal);
  expect_near(upright.right, {1, 0, 0}, "right");
  expect_near(upright.up, {0, 1, 0}, "up");
  const TangentFrame turned = tangent_frame(kCorners, {Vec2f{1, 1}, Vec2f{1, 0}, Vec2f{0, 1}}, normal);
  expect_near(turned.right, {0, -1, 0}, "turned: u falls along y");
  expect_near(turned.up, {1, 0, 0}, "turned: v falls along x");
  const TangentFrame mirrored = tangent_frame(kCorners, {Vec2f{1, 1}, Vec2f{0, 1}, Vec2f{1, 0}}, normal);
  expect_near(mirrored.right, {-1, 0, 0}, "mirrored");
  expect_near(mirrored.up, {0, 1, 0}, "mirrored");
  EXPECT_EQ(tangent_frame(kCorners, {}, normal).right, Vec3d{}) << "no place on the picture";
}

TEST(NormalMap, TangentsAndThePictureItselfGiveTheSameFrame) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 200; ++i) {
    // An orthogonal map, in which the derivatives of position by (u, v) stand at right angles.
    const Vec3d right = normalize(Vec3d{uniform(random), uniform(random), uniform(random)});
    const Vec3d up = normalize(cross(right, Vec3d{uniform(random), uniform(random), uniform(random)}));
    std::array<Vec3d, 3> corners;
    std::array<Vec2f, 3> uvs;
    for (size_t c = 0; c < 3; ++c) {
      uvs[c] = {static_cast<float>(uniform(random)), static_cast<float>(uniform(random))};
      corners[c] = right * static_cast<double>(uvs[c].x) - up * static_cast<double>(uvs[c].y);
    }
    const Vec3d front = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    if (length(cross(corners[1] - corners[0], corners[2] - corners[0])) < 1e-2) continue;
    const TangentFrame frame = tangent_frame(corners, uvs, front);
    expect_near(frame.right, right, "right");
    expect_near(frame.up, up, "up");
    const float sign = dot(cross(front, right), up) > 0 ? 1 : -1;
    expect_near(tangent_frame(right, sign, front).up, up, "by the sign");
  }
}

TEST(NormalMap, TheBackIsTurnedRoundAndNothingIsSeenFromBehind) {
  const TangentFrame frame{{1, 0, 0}, {0, 1, 0}};
  const Vec3d normal{0, 0, 1};
  const Vec3d slope = normalize(Vec3d{0.6, 0, 0.8});
  expect_near(mapped_normal({0.6f, 0, 0.8f}, frame, normal, 1, {0, 0, 1}), slope, "front");
  expect_near(mapped_normal({0.6f, 0, 0.8f}, frame, normal, -1, {0, 0, -1}), -slope, "back");
  expect_near(mapped_normal({0, 0, 0}, frame, normal, 1, {0, 0, 1}), normal, "a picture that says nothing");
  expect_near(mapped_normal({1, 0, 0}, TangentFrame{}, normal, -1, {0, 0, -1}), -normal, "no frame");
  const Vec3d grazing = normalize(Vec3d{-1, 0, 0.1});
  const Vec3d bent = mapped_normal({1, 0, 0.1f}, frame, normal, 1, grazing);
  EXPECT_GT(dot(bent, grazing), 0);
  EXPECT_LT(dot(bent, grazing), 0.01);
}

/// A floor at y = -1 under a light from straight above, with a picture of one pixel that leans by 0.6 along u: to the
/// right, or with `turned` to the viewer.
Shot leaning_floor(Vec3f code, bool turned = false) {
  Shot shot;
  shot.meshes = {parallelogram({-5, -1, 5}, {10, 0, 0}, {0, 0, -10}, 0)};
  shot.meshes[0].uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  if (turned) shot.meshes[0].uvs = {{1, 1}, {1, 0}, {0, 0}, {0, 1}};
  shot.materials = {lambert({1, 1, 1})};
  Pixels pixels{1, 1, {}, {code.x, code.y, code.z, 1}};
  shot.textures.resize(1);
  shot.textures[0].normal = std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::linear);
  shot.lights = {DirectionalLight{{-0.6f, -0.8f, 0}, {3.14159265f, 3.14159265f, 3.14159265f}}};
  return shot;
}

float lit(const Shot& shot) {
  return Shader(shot, ShadingKind::whitted, false).shade({{0, 0, 0}, {0.5f, -1, -0.25f}}, 0, 0, 0.5f).colour.x;
}

TEST(NormalMap, SurfacesLeanAsThePictureSays) {
  EXPECT_NEAR(lit(leaning_floor({0.5f, 0.5f, 1})), 0.8, 1e-5) << "straight up";
  EXPECT_NEAR(lit(leaning_floor({0.8f, 0.5f, 0.9f})), 1, 1e-5) << "towards the light";
  EXPECT_NEAR(lit(leaning_floor({0.5f, 0.8f, 0.9f})), 0.64, 1e-5) << "away from the viewer";
  EXPECT_NEAR(lit(leaning_floor({0.8f, 0.5f, 0.9f}, true)), 0.64, 1e-5) << "u towards the viewer";
  EXPECT_NEAR(lit(leaning_floor({0.5f, 0.8f, 0.9f}, true)), 1, 1e-5) << "and up the picture to the right";
  Shot half = leaning_floor({0.8f, 0.5f, 0.9f});
  half.materials[0].normal_scale = 0.5f;
  EXPECT_NEAR(lit(half), (0.3 * 0.6 + 0.8 * 0.8) / std::hypot(0.3, 0.8), 1e-5);
  Shot own = leaning_floor({0.8f, 0.5f, 0.9f});
  own.meshes[0].tangents = {std::vector<Vec4f>(4, {0, 0, 1, 1})};
  EXPECT_NEAR(lit(own), 0.64, 1e-5) << "the mesh's own tangents count before the picture's place";
  own.meshes[0].tangents = {std::vector<Vec4f>(4, {-1, 0, 0, 1})};
  EXPECT_NEAR(lit(own), 0.8 * 0.8 - 0.36, 1e-5);
}

TEST(NormalMap, TangentsMoveWithTheMesh) {
  Shot shot = leaning_floor({0.8f, 0.5f, 0.9f});
  Mesh& mesh = shot.meshes[0];
  mesh.positions.push_back(mesh.positions[0]);
  mesh.key_times = {0, 1};
  mesh.tangents = {std::vector<Vec4f>(4, {1, 0, 0, 1}), std::vector<Vec4f>(4, {0, 0, -1, 1})};
  const Shader shader(shot, ShadingKind::whitted, false);
  const auto at = [&](float time) { return shader.shade({{0, 0, 0}, {0.5f, -1, -0.25f}}, 0, 0, time).colour.x; };
  EXPECT_NEAR(at(0), 1, 1e-5);
  EXPECT_NEAR(at(1), 0.64, 1e-5);
  EXPECT_NEAR(at(0.5f), 0.64 + 0.36 * std::sqrt(0.5), 1e-5);
}

}  // namespace
}  // namespace kairos
