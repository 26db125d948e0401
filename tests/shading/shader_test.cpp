#include "shading/shader.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shading/surface.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr Vec3f kA{-1, -1, -2}, kB{1, -1, -2}, kC{0, 1, -2};

Mesh triangle_mesh() {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.positions = {{kA, kB, kC}};
  return mesh;
}

TEST(Surface, KeysBeforeAndAfterAJump) {
  Mesh mesh = triangle_mesh();
  const std::vector<Vec3f> key = mesh.positions[0];
  mesh.positions.assign(4, key);
  mesh.key_times = {0, 0.5f, 0.5f, 1};
  EXPECT_EQ(key_position(mesh, 0.25f).first, 0u);
  EXPECT_EQ(key_position(mesh, 0.25f).weight, 0.5f);
  EXPECT_EQ(key_position(mesh, 0.5f).first, 2u) << "from the jump on: the key after it";
  EXPECT_EQ(key_position(mesh, 0.5f).weight, 0);
  EXPECT_EQ(key_position(mesh, 1).second, 3u);
  EXPECT_EQ(key_position(mesh, 1).weight, 1);
}

TEST(Surface, BarycentricsFindThePointForBothFacings) {
  const std::array<Vec3d, 3> front{to_double(kA), to_double(kB), to_double(kC)};
  const std::array<Vec3d, 3> back{front[0], front[2], front[1]};
  const Vec3f point = kA * 0.5f + kB * 0.3f + kC * 0.2f;
  const Ray ray{{0.3f, 0.1f, 0}, point - Vec3f{0.3f, 0.1f, 0}};
  const auto w = barycentrics(front, ray), flipped = barycentrics(back, ray);
  const float expected[3] = {0.5f, 0.3f, 0.2f};
  const size_t swapped[3] = {0, 2, 1};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(w[i], expected[i], 1e-6);
    EXPECT_NEAR(flipped[swapped[i]], expected[i], 1e-6);
  }
}

TEST(Surface, BarycentricsAreAlwaysWeights) {
  const std::array<Vec3d, 3> edge_on{Vec3d{0, 0, -1}, Vec3d{0, 1, -1}, Vec3d{0, 0, -2}};
  for (const Ray ray : {Ray{{0, 0, 0}, {0, 0.1f, -1}}, Ray{{0, 0, 0}, {1, 0, 0}}}) {
    const auto w = barycentrics(edge_on, ray);
    EXPECT_NEAR(w[0] + w[1] + w[2], 1, 1e-6);
    for (const float v : w) EXPECT_GE(v, 0);
  }
}

TEST(Shader, GeometricNormalIsTurnedIntoTheWorldAtItsTime) {
  Shot shot;
  shot.meshes = {triangle_mesh()};
  shot.camera_moves = true;
  shot.world_from_camera = [](double time) {  // about y
    const double angle = time * M_PI / 2;
    return std::array<Vec3d, 3>{Vec3d{std::cos(angle), 0, -std::sin(angle)}, Vec3d{0, 1, 0},
                                Vec3d{std::sin(angle), 0, std::cos(angle)}};
  };
  const Shader shader(shot, ShadingKind::normal, false);
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  EXPECT_NEAR(shader.shade(ray, 0, 0, 0).colour.z, 1, 1e-6);
  EXPECT_NEAR(shader.shade(ray, 0, 0, 1).colour.x, 1, 1e-6);
  EXPECT_NEAR(shader.shade(ray, 0, 0, 0.5f).normal.x, std::sqrt(0.5), 1e-6);
}

TEST(Shader, OwnNormalsAreInterpolatedAndAlreadyInTheWorld) {
  Shot shot;
  shot.meshes = {triangle_mesh()};
  shot.meshes[0].normals = {{Vec3f{-1, 0, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}}};
  shot.world_from_camera = [](double) { return std::array<Vec3d, 3>{Vec3d{0, 0, -1}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}}; };
  const Shader shader(shot, ShadingKind::normal, false);
  const Shade shade = shader.shade({{0, 0, 0}, kA * 0.5f + kB * 0.3f + kC * 0.2f}, 0, 0, 0);
  const Vec3f expected = normalize(Vec3f{-0.5f, -0.3f, 0.2f});
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(shade.normal[i], expected[i], 1e-6);
    EXPECT_NEAR(shade.colour[i], std::abs(expected[i]), 1e-6);
  }
}

TEST(Shader, FlatIsBaseColourPlusEmission) {
  Shot shot;
  shot.meshes = {triangle_mesh()};
  shot.meshes[0].material = 1;
  shot.materials.resize(2);
  shot.materials[1].base_color = {0.1f, 0.2f, 0.3f};
  shot.materials[1].emission = {0, 5, 0};
  const Shade shade = Shader(shot, ShadingKind::flat, false).shade({{0, 0, 0}, {0, 0, -1}}, 0, 0, 0);
  EXPECT_EQ(shade.colour, (Vec3f{0.1f, 5.2f, 0.3f}));
  EXPECT_EQ(shade.albedo, (Vec3f{0.1f, 0.2f, 0.3f}));
}

TEST(Shader, OnlyWhatMovesVaries) {
  Shot shot;
  shot.meshes = {triangle_mesh(), triangle_mesh(), triangle_mesh()};
  shot.meshes[1].positions.push_back(shot.meshes[1].positions[0]);
  shot.meshes[1].key_times = {0, 1};
  shot.meshes[2].normals.assign(2, {kA, kB, kC});
  const Shader normal(shot, ShadingKind::normal, false), flat(shot, ShadingKind::flat, false);
  EXPECT_FALSE(normal.varies(0));
  EXPECT_TRUE(normal.varies(1));
  EXPECT_TRUE(normal.varies(2));
  EXPECT_FALSE(flat.varies(1));
  EXPECT_TRUE(Shader(shot, ShadingKind::flat, true).varies(1)) << "its normal is asked for";
  shot.camera_moves = true;
  shot.world_from_camera = [](double) { return std::array<Vec3d, 3>{}; };
  EXPECT_TRUE(Shader(shot, ShadingKind::normal, false).varies(0));
}

TEST(Shader, ATriangleWithoutAreaIsBlackNotNaN) {
  Shot shot;
  shot.meshes = {triangle_mesh()};
  shot.meshes[0].positions[0][2] = kA;
  EXPECT_EQ(Shader(shot, ShadingKind::normal, false).shade({{0, 0, 0}, {0, 0, -1}}, 0, 0, 0).colour, Vec3f{});
}

TEST(Shader, MirrorsAndClearGlassShowOtherThings) {
  Shot shot;
  shot.materials = {mirror({0.9f, 0.8f, 0.7f}), glass(1.5f), lambert({0.5f, 0.5f, 0.5f}), mirror({1, 1, 1}),
                    lambert({})};
  shot.materials[3].roughness = 0.4f;
  shot.materials[4].roughness = 0;  // black lacquer: but for its highlights it is dark
  shot.meshes.assign(5, triangle_mesh());
  for (uint32_t m = 0; m < 5; ++m) shot.meshes[m].material = m;
  const Shader lit(shot, ShadingKind::whitted, false), unlit(shot, ShadingKind::normal, false);
  for (uint32_t m = 0; m < 5; ++m) {
    EXPECT_EQ(lit.shows_others(m), m == 0 || m == 1 || m == 4) << m;
    EXPECT_FALSE(unlit.shows_others(m)) << m;
  }
}

}  // namespace
}  // namespace kairos
