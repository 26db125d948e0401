// Shadows exact in time: what passes between a resting surface and a resting light.
#include "shading/exact_shadows.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <kairos/names.h>
#include <kairos/render.h>

#include "pixel_means.h"
#include "seed.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

/// Slides along x while the shutter is open.
Mesh sliding(Mesh mesh, float way) {
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions[1]) p.x += way;
  mesh.key_times = {0, 1};
  return mesh;
}

/// A floor that fills the frame, seen from above (along -z), with light that comes to it along (1, 0, -1) and a hundred
/// narrow slats on its way, out of sight.
Shot slats(int count, float way) {
  Shot shot;
  shot.materials = {lambert({0.5f, 0.5f, 0.5f})};
  shot.meshes = {parallelogram({-20, -20, -10}, {40, 0, 0}, {0, 40, 0}, 0)};
  const float apart = 8.0f / static_cast<float>(count);
  for (int i = 0; i < count; ++i)
    shot.meshes.push_back(
        sliding(parallelogram({-12 + apart * static_cast<float>(i), -5, -2}, {apart / 2, 0, 0}, {0, 10, 0}, 0), way));
  shot.lights = {DirectionalLight{{1, 0, -1}, {3, 3, 3}}};
  shot.projection.width = 8;
  shot.projection.height = 6;
  shot.projection.orthographic = true;
  shot.projection.view_height = 0.1;
  return shot;
}

constexpr std::array kIntegrators{IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic};

RenderParams params_of(Shadows shadows, int rays, int samples, ShadingKind shading = ShadingKind::whitted,
                       IntegratorKind integrator = IntegratorKind::tc) {
  RenderParams params;
  params.integrator = integrator;
  params.spp = 4 * rays;
  params.shading = shading;
  params.shadows = shadows;
  params.tc_rays = rays;
  params.shading_samples = samples;
  return params;
}

TEST(ExactShadows, OfSlatsThatPass) {
  // The edges pass each point of the floor: of one slat, for 0.1 of the way that is 2 units long.
  Shot shot = slats(1, 2);
  shot.meshes[1] = sliding(parallelogram({-9, -5, -2}, {0.2f, 0, 0}, {0, 10, 0}, 0), 2);
  const double lit = 3 / std::numbers::sqrt2 * 0.5 / std::numbers::pi;
  for (const ShadingKind shading : {ShadingKind::whitted, ShadingKind::path})
    for (const IntegratorKind integrator : kIntegrators) {
      const Image image = render(shot, params_of(Shadows::exact, 1, 1, shading, integrator));
      for (const float value : image.find("R")->values) EXPECT_NEAR(value, 0.9 * lit, 1e-5 * lit);
    }
}

/// A shadow's edge passes: each pixel is lit until then, though neighbours' rays go together.
TEST(ExactShadows, BelongToTheirPixels) {
  Shot shot = slats(1, 2);
  shot.meshes[1] = sliding(parallelogram({-12, -5, -2}, {3.5f, 0, 0}, {0, 10, 0}, 0), 2);
  const double lit = 3 / std::numbers::sqrt2 * 0.5 / std::numbers::pi, pixel = 0.1 / 6;
  for (const IntegratorKind integrator : kIntegrators)
    for (const int rays : {1, 4}) {
      const Image image = render(shot, params_of(Shadows::exact, rays, 1, ShadingKind::whitted, integrator));
      for (size_t i = 0; i < 48; ++i) {
        const double x = (static_cast<double>(i % 8) + 0.5 - 4) * pixel;
        EXPECT_NEAR(image.find("R")->values[i], lit * (x + 0.5) / 2, lit * pixel / 3) << to_string(integrator) << rays;
      }
    }
}

/// Two suns, of which one stands straight above, and one lamp; triangles of all sizes that fly about.
TEST(ExactShadows, OfPointsBesideEachOtherAreThoseOfEachAlone) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto vector = [&] {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    return Vec3f{x, y, z};
  };
  Shot shot;
  shot.materials = {lambert({0.5f, 0.5f, 0.5f})};
  shot.meshes = {parallelogram({-20, -20, -10}, {40, 0, 0}, {0, 40, 0}, 0)};
  for (int i = 0; i < 200; ++i) {
    const float size = 0.05f + 0.5f * std::abs(uniform(random));
    shot.meshes.push_back(sliding(parallelogram(vector() * 3 + Vec3f{0, 0, -6}, vector() * size, vector() * size, 0),
                                  4 * uniform(random)));
  }
  const Vec3f slanted{uniform(random), uniform(random), -1};
  shot.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}, DirectionalLight{slanted, {1, 1, 1}},
                 PointLight{{0, 0, -1}, {30, 30, 30}}};
  shot.projection.width = 8;
  shot.projection.height = 6;
  shot.projection.orthographic = true;
  shot.projection.view_height = 0.1;
  const Shader shader(shot, ShadingKind::whitted, false);
  const Tracer tracer(shot.meshes, {Precision::fast, {}});
  const DiscreteScene scene(shot.meshes);
  const ExactShadows shadows(shader, tracer, scene, shader.resting_receivers());
  RestingLightSteps together, alone;
  int looks = 0, same = 0, changes = 0;
  for (int round = 0; round < 20; ++round) {
    // They are looked at from straight above, within a few pixels, and one from farther off.
    std::vector<Ray> rays;
    const Vec3f middle = Vec3f{uniform(random), uniform(random), 0} * 2;
    for (int i = 0; i < 20; ++i) {
      const float apart = i == 19 ? 3 : 0.02f;
      rays.push_back({middle + Vec3f{uniform(random), uniform(random), 0} * apart + Vec3f{0, 0, -9}, {0, 0, -1}});
    }
    together.clear();
    for (const Ray& ray : rays) together.add(shadows, ray, 0, 0);
    together.look(shadows, {});
    ASSERT_EQ(together.points(), rays.size());
    const auto light = [](std::span<const RestingLightSteps::Step> steps) {
      float begin = 0;
      double sum = 0;
      for (const auto& step : steps) {
        sum += static_cast<double>(step.light.x * (step.end - begin));
        begin = step.end;
      }
      EXPECT_EQ(begin, 1);
      return sum;
    };
    for (size_t i = 0; i < rays.size(); ++i) {
      alone.look(shadows, rays[i], 0, 0, {});
      EXPECT_EQ(together.lights(i), alone.lights());
      EXPECT_EQ(together.unhidden(i), alone.unhidden());
      ++looks;
      same += std::abs(light(together.steps(i)) - light(alone.steps())) < 1e-3 * alone.unhidden().x;
      changes += alone.changes();
    }
  }
  EXPECT_GT(changes, looks / 4) << "seed " << seed;
  EXPECT_GE(same, looks - looks / 100) << "seed " << seed;
  if (tracer.instruction_set() == InstructionSet::scalar) return;
  EXPECT_EQ(together.counters().rays, alone.counters().rays);
  EXPECT_LT(together.counters().nodes, alone.counters().nodes * 2 / 3);  // those to the lamp go alone
}

/// Where they are sampled, the rays of a pixel that see one thing all the time look at it at instants of their own.
TEST(ExactShadows, SampledOnesAreSpreadOverTheShutter) {
  Shot shot = slats(1, 2);
  shot.meshes[1] = sliding(parallelogram({-9, -5, -2}, {0.2f, 0, 0}, {0, 10, 0}, 0), 2);
  const double lit = 3 / std::numbers::sqrt2 * 0.5 / std::numbers::pi;
  RenderParams params = params_of(Shadows::sampled, 16, 1);
  params.seed = test::seed();
  const Image image = render(shot, params);
  // Hidden for 1.6 of 16 equal parts of the shutter, of which each is looked at once.
  for (const float value : image.find("R")->values) EXPECT_NEAR(value, 0.9 * lit, 0.11 * lit);
}

/// 256 seeds with KAIROS_LONG.
TEST(ExactShadows, HaveTheMeanOfSampledOnes) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  Shot shot = slats(20, 1);
  for (int i = 0; i < 6; ++i)  // seen by the camera, some at rest
    shot.meshes.push_back(ball({0.04f * uniform(random), 0.04f * uniform(random), -5 + uniform(random)}, 0.02f, 6, 0));
  for (size_t m = shot.meshes.size() - 3; m < shot.meshes.size(); ++m) shot.meshes[m] = sliding(shot.meshes[m], 0.05f);
  shot.lights.push_back(PointLight{{1, 0.5f, -1}, {30, 20, 10}});
  shot.lights.push_back(ConstantLight{{0.2f, 0.2f, 0.2f}});
  const int seeds = test::seeds_of_means(48);
  Renderer renderer(shot);
  const auto sums_of = [&](Shadows shadows, IntegratorKind integrator) {
    return test::sums_over_seeds(renderer, params_of(shadows, 2, 4, ShadingKind::whitted, integrator), seeds, random);
  };
  const test::PixelSums sampled = sums_of(Shadows::sampled, IntegratorKind::qmc);
  for (const IntegratorKind integrator : kIntegrators)
    test::expect_same_means(sums_of(Shadows::exact, integrator), sampled, seeds, std::string(to_string(integrator)));
}

/// How many time-continuous rays went to lights: counters of nodes beside those of the same picture without any.
bool uses_exact(const Shot& shot, int samples, IntegratorKind integrator) {
  RenderStats automatic, sampled;
  render(shot, params_of(Shadows::automatic, 4, samples, ShadingKind::whitted, integrator), &automatic);
  render(shot, params_of(Shadows::sampled, 4, samples, ShadingKind::whitted, integrator), &sampled);
  return automatic.counters.triangles > sampled.counters.triangles;
}

TEST(ExactShadows, AreChosenWhereTheyAreWorthIt) {
  Shot shot = slats(100, 4);
  shot.projection.width = shot.projection.height = 64;
  for (const IntegratorKind integrator : kIntegrators) EXPECT_TRUE(uses_exact(shot, 8, integrator));
  // Nothing moves but something far off: one discrete ray says as much.
  Shot still = slats(400, 0);
  for (size_t m = 1; m < still.meshes.size(); ++m) {
    still.meshes[m].positions.resize(1);
    still.meshes[m].key_times.clear();
  }
  still.meshes.push_back(sliding(parallelogram({100, 0, -2}, {1, 0, 0}, {0, 1, 0}, 0), 1));
  still.projection.width = still.projection.height = 64;
  still.projection.view_height = 4;
  for (const IntegratorKind integrator : kIntegrators) EXPECT_FALSE(uses_exact(still, 1, integrator));
}

TEST(ExactShadows, AreNotForWhatMovesOrLetsLightThrough) {
  Shot shot = slats(4, 2);
  const auto receivers = [&] { return Shader(shot, ShadingKind::whitted, false).resting_receivers(); };
  EXPECT_EQ(receivers(), (std::vector<bool>{true, false, false, false, false}));
  shot.materials.push_back(glass(1.5f));
  EXPECT_TRUE(receivers()[0]);
  shot.meshes[1].material = 1;
  EXPECT_FALSE(receivers()[0]);
  shot.meshes[1].material = 0;
  shot.meshes[1].one_sided = true;
  EXPECT_FALSE(receivers()[0]);
  shot.meshes[1].one_sided = false;
  shot.camera_moves = true;
  EXPECT_FALSE(receivers()[0]);
}

TEST(ExactShadows, AreTheSameInACropAndForAnyNumberOfThreads) {
  Shot shot = slats(20, 2);
  shot.meshes.push_back(sliding(ball({0, 0, -5}, 0.02f, 6, 0), 0.02f));
  for (const IntegratorKind integrator : kIntegrators)
    for (const Shadows shadows : {Shadows::automatic, Shadows::exact}) {
      RenderParams params = params_of(shadows, 4, 2, ShadingKind::whitted, integrator);
      const Image whole = render(shot, params);
      params.threads = 1;
      params.crop = Crop{2, 6, 1, 5};
      const Image part = render(shot, params);
      for (int y = 1; y < 5; ++y)
        for (int x = 2; x < 6; ++x)
          EXPECT_EQ(part.find("R")->values[static_cast<size_t>((y - 1) * 4 + x - 2)],
                    whole.find("R")->values[static_cast<size_t>(y * 8 + x)]);
    }
}

}  // namespace
}  // namespace kairos
