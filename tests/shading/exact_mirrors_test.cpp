// Mirrors and panes exact in time: what they show of what moves, where they and the camera rest.
#include "shading/exact_mirrors.h"

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/names.h>
#include <kairos/render.h>

#include "pixel_means.h"
#include "seed.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

Mesh carried(Mesh mesh, Vec3f way) {
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions[1]) p = p + way;
  mesh.key_times = {0, 1};
  return mesh;
}

/// A camera that looks along -z at what fills the frame.
Shot looking_at(std::vector<Mesh> meshes) {
  Shot shot;
  shot.materials = {mirror({1, 1, 1}), glass(1.5f), lamp({1, 1, 1}), lambert({0.6f, 0.5f, 0.4f})};
  shot.materials[1].thin_walled = true;
  shot.meshes = std::move(meshes);
  shot.projection.width = 8;
  shot.projection.height = 6;
  shot.projection.orthographic = true;
  shot.projection.view_height = 0.1;
  return shot;
}

constexpr std::array kWithMirrors{IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic};

RenderParams mirror_params(Mirrors mirrors, int rays, int samples, IntegratorKind integrator = IntegratorKind::tc) {
  RenderParams params;
  params.integrator = integrator;
  params.shading = ShadingKind::whitted;
  params.mirrors = mirrors;
  params.tc_rays = rays;
  params.spp = 4 * rays;
  params.shading_samples = samples;
  return params;
}

void expect_one_value(const Image& image, double value) {
  for (const float seen : image.find("R")->values) EXPECT_NEAR(seen, value, 1e-5 * value);
}

TEST(ExactMirrors, ShowWhatPasses) {
  // Turned by 45 degrees it sends rays along -x, where a narrow lamp passes each of them for a tenth of the shutter: it
  // is 0.2 wide and goes 2.
  const Mesh at_45_degrees = parallelogram({-1, -1, -11}, {0, 2, 0}, {2, 0, 2}, 0);
  const Mesh lamp = carried(parallelogram({-5, -5, -10.9f}, {0, 0, -0.2f}, {0, 10, 0}, 2), {0, 0, 2});
  const Shot shot = looking_at({at_45_degrees, lamp});
  for (const IntegratorKind integrator : kWithMirrors)
    expect_one_value(render(shot, mirror_params(Mirrors::exact, 1, 1, integrator)), 0.1);
}

/// A picture that is large enough for a race, and one that is not.
TEST(ExactMirrors, AreThereWhereARaceIsWon) {
  const Mesh at_45_degrees = parallelogram({-1, -1, -11}, {0, 2, 0}, {2, 0, 2}, 0);
  const Mesh lamp = carried(parallelogram({-5, -5, -10.9f}, {0, 0, -0.2f}, {0, 10, 0}, 2), {0, 0, 2});
  Shot shot = looking_at({at_45_degrees, lamp});
  const auto seen = [&](IntegratorKind integrator) {
    return render(shot, mirror_params(Mirrors::automatic, 4, 1, integrator));
  };
  EXPECT_GT(std::abs(seen(IntegratorKind::automatic).find("R")->values[0] - 0.1f), 0.01f) << "16 discrete samples";
  shot.projection.width = 48;
  shot.projection.height = 32;
  expect_one_value(seen(IntegratorKind::automatic), 0.1);
  expect_one_value(seen(IntegratorKind::mixed), 0.1);
}

TEST(ExactMirrors, LetSeeWhatPassesBehindPanes) {
  const Mesh pane = parallelogram({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}, 1);
  const Mesh lamp = carried(parallelogram({-1.2f, -5, -10}, {0.2f, 0, 0}, {0, 10, 0}, 2), {2, 0, 0});
  const double one_face = 0.04, pane_reflects = 2 * one_face / (1 + one_face);
  expect_one_value(render(looking_at({pane, lamp}), mirror_params(Mirrors::exact, 1, 1)), 0.1 * (1 - pane_reflects));
}

/// Bent mirrors, glass, mirrors in mirrors, edges of mirrors, and what rests: 256 seeds with KAIROS_LONG.
TEST(ExactMirrors, HaveTheMeanOfDiscreteRays) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto somewhere = [&] { return Vec3f{2 * uniform(random), 2 * uniform(random), 4 + uniform(random)}; };
  Shot shot =
      looking_at({parallelogram({-2, -2, -2}, {2, 0, 0}, {0, 4, 0}, 0), ball({0.5f, 0.3f, -1}, 0.6f, 8, 0),
                  ball({0.9f, -0.6f, -0.5f}, 0.5f, 8, 1), parallelogram({-9, -9, -4}, {18, 0, 0}, {0, 18, 0}, 3)});
  shot.materials[1].thin_walled = false;
  shot.projection.view_height = 2.5;
  for (int i = 0; i < 8; ++i) shot.meshes.push_back(carried(ball(somewhere(), 0.5f, 4, 3), somewhere() - somewhere()));
  shot.meshes.push_back(carried(ball({-1.5f, -0.5f, -1}, 0.4f, 4, 3), {1.5f, 0.2f, 0}));
  shot.lights = {DirectionalLight{{0.4f, -1, -0.8f}, {3, 3, 3}}, PointLight{{1, 2, 3}, {20, 15, 10}}};
  shot.background = {0.2f, 0.3f, 0.4f};
  const int seeds = test::seeds_of_means(64);
  Renderer renderer(shot);
  RenderParams discrete = mirror_params(Mirrors::sampled, 2, 2);
  discrete.integrator = IntegratorKind::qmc;
  const auto sampled = test::sums_over_seeds(renderer, discrete, seeds, random);
  for (const IntegratorKind integrator : kWithMirrors) {
    const auto exact = test::sums_over_seeds(renderer, mirror_params(Mirrors::exact, 2, 2, integrator), seeds, random);
    test::expect_same_means(exact, sampled, seeds, std::string(to_string(integrator)));
  }
}

TEST(ExactMirrors, AreThoseThatRestBeforeACameraThatDoes) {
  Shot shot = looking_at({parallelogram({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}, 0),
                          parallelogram({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}, 1),
                          carried(parallelogram({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}, 0), {1, 0, 0}),
                          parallelogram({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}, 3)});
  const auto mirrors = [&](ShadingKind shading) { return Shader(shot, shading, false).resting_mirrors(); };
  EXPECT_EQ(mirrors(ShadingKind::whitted), (std::vector<bool>{true, true, false, false}));
  EXPECT_EQ(mirrors(ShadingKind::path), std::vector<bool>(4));
  shot.camera_moves = true;
  EXPECT_EQ(mirrors(ShadingKind::whitted), std::vector<bool>(4));
}

}  // namespace
}  // namespace kairos
