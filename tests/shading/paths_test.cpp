// Path tracing against what light must do: energy, closed forms, and Whitted's shading where both mean the same.
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "pixel_means.h"
#include "seed.h"
#include "shading/microfacets.h"
#include "shading/scattering.h"
#include "shading/shader.h"
#include "shading/shadow_rays.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

struct Seen {
  Vec3d mean, error;  // standard error of the mean, as if samples were independent
};

Seen seen_by(const Shot& shot, ShadingKind kind, const Ray& ray, uint32_t samples, int max_depth, float clamp = 0) {
  const auto scene =
      std::make_shared<const DiscreteScene>(shot.meshes, DiscreteOptions{true, nullptr, 0, panes_of(shot)});
  const Shader shader(shot, kind, false, max_depth, scene, false, clamp);
  const auto hit = scene->intersect(ray, 0.5f);
  if (!hit) {
    ADD_FAILURE() << "the ray sees nothing";
    return {};
  }
  Vec3d sum, squares;
  for (uint32_t i = 0; i < samples; ++i) {
    const Vec3d colour = to_double(shader.shade(ray, hit->mesh, hit->triangle, 0.5f, {7, i}).colour);
    sum += colour;
    squares += colour * colour;
  }
  const double n = samples;
  const Vec3d mean = sum / n, spread = squares / n - mean * mean;
  const auto root = [&](double v) { return std::sqrt(std::max(v, 0.0) / n); };
  return {mean, {root(spread.x), root(spread.y), root(spread.z)}};
}

Material rough_metal(float roughness) {
  Material material = mirror({1, 1, 1});
  material.roughness = roughness;
  return material;
}
Material rough_glass(float roughness, bool thin) {
  Material material = glass(1.5f);
  material.roughness = roughness;
  material.thin_walled = thin;
  return material;
}

/// Several, from plain to everything at once.
std::vector<Material> materials() {
  Material plastic = lambert({0.8f, 0.5f, 0.2f}), lacquered = rough_metal(0.6f), all = rough_glass(0.5f, false);
  plastic.roughness = 0.3f;
  lacquered.base_color = {0.9f, 0.6f, 0.3f};
  lacquered.clearcoat = 0.8f;
  lacquered.clearcoat_roughness = 0.25f;
  all.transmission = 0.5f;
  all.metallic = 0.3f;
  all.base_color = {0.7f, 0.8f, 0.9f};
  return {lambert({0.5f, 0.25f, 1}), plastic, rough_metal(0.5f), lacquered, rough_glass(0.5f, false),
          rough_glass(0.4f, true),   all};
}

SurfacePoint point_on(const Material& material, Vec3d to_viewer, bool entering) {
  SurfacePoint point;
  point.material = &material;
  point.look = {material.base_color, {}, 1, material.metallic, material.roughness};
  point.face = point.normal = {0, 0, 1};
  point.to_viewer = to_viewer;
  point.entering = entering;
  return point;
}

Vec3d any_direction(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const double z = number(random), turn = M_PI * number(random), across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// What sample() gives is distributed as density() says and weighed as value() says: both ways to the same integrals.
TEST(Scattering, SamplesAreWhatTheirDensitySays) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> number(0, 1);
  for (const Material& material : materials())
    for (const bool entering : {true, false}) {
      Vec3d viewer = any_direction(random);
      viewer.z = std::abs(viewer.z) + 0.4;  // lobes seen along the surface are too narrow for even sampling
      const SurfacePoint point = point_on(material, normalize(viewer), entering);
      const Scattering scatter(point);
      // Integrals over all directions of value, and of value times a smooth weight that tells directions apart.
      const Vec3d axis = any_direction(random);
      constexpr int kSamples = 20000;
      Vec3d by_sampling, evenly;
      double squares = 0, even_squares = 0, likely = 0, likely_squares = 0;
      for (int i = 0; i < kSamples; ++i) {
        if (const auto sample = scatter.sample({number(random), number(random), number(random)})) {
          ASSERT_FALSE(sample->is_sharp());
          const double weight = 1 + dot(axis, sample->direction);
          by_sampling += to_double(sample->weight) * weight;
          squares += std::pow(static_cast<double>(sample->weight.x) * weight, 2);
        }
        const Vec3d direction = any_direction(random);
        const Vec3d value = to_double(scatter.value(direction)) * (4 * M_PI * (1 + dot(axis, direction)));
        evenly += value;
        even_squares += value.x * value.x;
        const double density = 4 * M_PI * scatter.density(direction);
        likely += density;
        likely_squares += density * density;
      }
      const double n = kSamples, tolerance = 7 * std::sqrt((squares + even_squares) / n / n) + 2e-3;
      EXPECT_NEAR(by_sampling.x / n, evenly.x / n, tolerance) << material.roughness << ' ' << entering;
      // Chance may lead into the surface, never out of what density() knows.
      EXPECT_LE(likely / n, 1 + 7 * std::sqrt(likely_squares / n / n));
      EXPECT_GE(likely / n, 0.6);
    }
}

TEST(Scattering, NoSurfaceGivesMoreThanItGets) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> number(0, 1);
  for (const Material& material : materials()) {
    Vec3d viewer = any_direction(random);
    viewer.z = std::abs(viewer.z) + 0.05;
    const SurfacePoint point = point_on(material, normalize(viewer), true);
    const Scattering scatter(point);
    double sum = 0, squares = 0;
    constexpr int kSamples = 4000;
    for (int i = 0; i < kSamples; ++i)
      if (const auto sample = scatter.sample({number(random), number(random), number(random)})) {
        // Into glass, radiance falls by the square of the refractive index.
        const bool inside = sample->direction.z < 0 && !material.thin_walled;
        const double share = static_cast<double>(largest(sample->weight)) * (inside ? 2.25 : 1);
        sum += share;
        squares += share * share;
      }
    EXPECT_LE(sum / kSamples, 1 + 5 * std::sqrt(squares) / kSamples) << material.roughness << ' ' << material.metallic;
  }
}

/// With what goes to and fro between facets a white metal keeps nothing, whatever its roughness and the viewer's slant.
TEST(Scattering, AWhiteRoughMetalReflectsAll) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> number(0, 1);
  for (int i = 0; i < 20; ++i) {
    const Material metal = rough_metal(0.1f + 0.9f * number(random));
    const double slant = 1.5 * static_cast<double>(number(random));
    const SurfacePoint point = point_on(metal, {std::sin(slant), 0, std::cos(slant)}, true);
    const Scattering scatter(point);
    double mean = 0;
    constexpr int kSteps = 100;
    for (int u = 0; u < kSteps; ++u)
      for (int v = 0; v < kSteps; ++v)
        if (const auto s = scatter.sample(
                {(static_cast<float>(u) + 0.5f) / kSteps, (static_cast<float>(v) + 0.5f) / kSteps, 0.5f}))
          mean += static_cast<double>(s->weight.x) / (kSteps * kSteps);
    EXPECT_NEAR(mean, 1, 0.01) << metal.roughness << ' ' << slant;
  }
}

/// Of rough glass what is sent away goes to either side: by chance, so the mean has noise.
TEST(Scattering, ClearRoughGlassKeepsNothing) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> number(0, 1);
  const float ior = 1.2f + 0.8f * number(random);
  for (int i = 0; i < 16; ++i) {
    const bool thin = i % 4 == 0, entering = i % 2 == 0;
    Material material = rough_glass(0.1f + 0.9f * number(random), thin);
    material.ior = ior;
    const double slant = 1.5 * static_cast<double>(number(random));
    const SurfacePoint point = point_on(material, {std::sin(slant), 0, std::cos(slant)}, entering);
    const Scattering scatter(point);
    const double eta = thin ? 1 : Boundary(material, point.look, entering).eta();
    double mean = 0;
    constexpr int kSteps = 40;
    for (int u = 0; u < kSteps; ++u)
      for (int v = 0; v < kSteps; ++v)
        for (int w = 0; w < kSteps; ++w) {
          const auto at = [](int step) { return (static_cast<float>(step) + 0.5f) / kSteps; };
          const auto s = scatter.sample({at(u), at(v), at(w)});
          if (!s) continue;
          // Light is denser in what is denser.
          const double denser = s->direction.z < 0 ? eta * eta : 1;
          mean += static_cast<double>(s->weight.x) * denser / (kSteps * kSteps * kSteps);
        }
    EXPECT_NEAR(mean, 1, 0.012) << material.roughness << ' ' << material.ior << ' ' << slant << ' ' << thin << entering;
  }
}

TEST(Paths, InAWhiteWorldWhiteThingsCannotBeSeen) {
  for (const Material& material : {lambert({1, 1, 1}), mirror({1, 1, 1}), glass(1.5f), rough_glass(0, true),
                                   rough_metal(0.8f), rough_glass(0.6f, false)}) {
    Shot shot;
    shot.materials = {material};
    shot.lights = {ConstantLight{{1, 2, 4}}};
    shot.meshes = {box({-1, -1, -5}, {1, 1, -3}, 0), box({-1, 1.5f, -5}, {1, 2, -3}, 0)};
    for (const Vec3f direction : {Vec3f{0.2f, -0.15f, -1}, Vec3f{0.28f, 0.29f, -1}}) {
      const Seen seen = seen_by(shot, ShadingKind::path, {{0, 0, 0}, direction}, 4096, 64);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(seen.mean[c], 1 << c, 5 * seen.error[c] + 0.005 * (1 << c)) << material.transmission;
    }
  }
}

/// Inside of a closed box that shines e and reflects r of what falls on it, each bounce brings r times as much.
TEST(Paths, InsideOfAShiningBoxLightIsAGeometricSeries) {
  Shot shot;
  shot.materials = {lambert({0.5f, 0.25f, 0.75f})};
  shot.materials[0].emission = {1, 1, 1};
  shot.meshes = {box({-1, -2, -3}, {1, 1, 2}, 0)};
  const Ray ray{{0, 0, 0}, {0.3f, -0.2f, -1}};
  for (const int depth : {0, 1, 3, 64}) {
    const Seen seen = seen_by(shot, ShadingKind::path, ray, 2048, depth);
    for (int c = 0; c < 3; ++c) {
      const auto r = static_cast<double>(shot.materials[0].base_color[c]);
      EXPECT_NEAR(seen.mean[c], (1 - std::pow(r, depth + 2)) / (1 - r), 5 * seen.error[c] + 1e-4) << depth;
    }
  }
}

/// What falls on the floor straight from a lamp, a lamp behind a pane, the sky and a spot is the same in both shadings.
TEST(Paths, DirectLightIsThatOfWhittedsShading) {
  Shot shot;
  shot.materials = {lambert({0.5f, 0.25f, 1}), lamp({5, 4, 3}), rough_glass(0, true)};
  shot.meshes = {
      parallelogram({-10, -1, 10}, {20, 0, 0}, {0, 0, -20}, 0), parallelogram({0, 1, -3}, {2, 0, 0}, {0, 0, 2}, 1),
      parallelogram({-2, 2, -3}, {0.5f, 0, 0}, {0, 0, 2}, 1), parallelogram({-5, 1, -5}, {4.9f, 0, 0}, {0, 0, 8}, 2)};
  shot.lights = {ConstantLight{{0.2f, 0.3f, 0.4f}}, SpotLight{{1, 2, 0}, {0, -1, 0}, {9, 9, 9}, 0.9f, 0.1f}};
  const Ray ray{{0, 0, 0}, {1, -1, -2}};
  for (const bool one_sided : {false, true}) {
    shot.meshes[0].one_sided = one_sided;
    const Seen whitted = seen_by(shot, ShadingKind::whitted, ray, 4096, 0);
    const Seen path = seen_by(shot, ShadingKind::path, ray, 4096, 0);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(path.mean[c], whitted.mean[c], 5 * std::hypot(path.error[c], whitted.error[c])) << one_sided;
    EXPECT_GT(whitted.mean.x, 0.1);
  }
}

TEST(Paths, AClampTakesFromWhatIsScatteredMoreThanOnceAlone) {
  Shot shot;
  shot.materials = {lambert({0.5f, 0.5f, 0.5f})};
  shot.materials[0].emission = {1, 1, 1};
  shot.meshes = {box({-1, -2, -3}, {1, 1, 2}, 0)};
  const Ray ray{{0, 0, 0}, {0.3f, -0.2f, -1}};
  EXPECT_NEAR(seen_by(shot, ShadingKind::path, ray, 512, 8, 1e-6f).mean.x, 1.5, 0.01);
  const double some = seen_by(shot, ShadingKind::path, ray, 512, 8, 0.25f).mean.x;
  EXPECT_GT(some, 1.6);
  EXPECT_LE(some, 1.76);
}

/// Frosted glass over a lamp: what it lets through is found from both ends, by looking for the lamp and by scattering.
TEST(Paths, FrostedGlassShowsALampBehindIt) {
  for (const bool thin : {true, false}) {
    Shot shot;
    shot.materials = {rough_glass(0.5f, thin), lamp({4, 4, 4})};
    shot.meshes = {parallelogram({-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, 0),
                   parallelogram({-0.5f, -0.5f, -4}, {1, 0, 0}, {0, 1, 0}, 1)};
    const Ray ray{{0, 0, 0}, {0.1f, 0.05f, -1}};
    const Seen lit = seen_by(shot, ShadingKind::path, ray, 4096, 8);
    // All of what it scatters by quadrature over the lamp.
    const Vec3d position = to_double(ray.direction) * 2.0, viewer = -normalize(to_double(ray.direction));
    const SurfacePoint point = point_on(shot.materials[0], viewer, true);
    const Scattering scatter(point);
    double expected = 0;
    constexpr int kSteps = 100;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const Vec3d way = Vec3d{(i + 0.5) / kSteps - 0.5, (j + 0.5) / kSteps - 0.5, -4} - position;
        const double squared = dot(way, way), cosine = -way.z / std::sqrt(squared);
        expected += 4 * static_cast<double>(scatter.value(normalize(way)).x) * cosine / squared / (kSteps * kSteps);
      }
    EXPECT_NEAR(lit.mean.x, expected, 5 * lit.error.x + 1e-3 * expected) << thin;
    EXPECT_GT(expected, 0.1);
    EXPECT_LT(lit.error.x * std::sqrt(4096.0), 0.7 * expected) << "noise, if it were found from one end alone";
  }
}

/// Time-continuous rays that share a list of samples over the pixel, and discrete ones, have the same mean in every
/// pixel, whatever their noise; and no pixel is negative or no number. 256 seeds with KAIROS_LONG.
TEST(Paths, TimeContinuousRaysHaveTheMeanOfDiscreteOnes) {
  Shot shot;
  shot.projection.width = 16;
  shot.projection.height = 12;
  shot.materials = {lambert({0.7f, 0.5f, 0.4f}), lamp({5, 4, 3}), rough_metal(0.4f), rough_glass(0, true)};
  shot.meshes = {parallelogram({-10, -1, 10}, {20, 0, 0}, {0, 0, -20}, 0),
                 parallelogram({0, 1, -5}, {2, 0, 0}, {0, 0, 2}, 1), box({-1, -1, -4}, {0.2f, 0, -3}, 2),
                 parallelogram({0.3f, -1, -2.5f}, {1, 0, 0}, {0, 1, 0}, 3)};
  shot.meshes[2].positions.push_back(shot.meshes[2].positions[0]);
  for (Vec3f& p : shot.meshes[2].positions[1]) p = p + Vec3f{0.8f, 0.3f, 0};
  shot.meshes[2].key_times = {0, 1};
  shot.lights = {ConstantLight{{0.3f, 0.4f, 0.5f}}, PointLight{{-2, 2, 0}, {6, 6, 6}}};
  const int seeds = test::seeds_of_means(24);
  std::mt19937 random(test::seed());
  Renderer renderer(shot);
  const auto sums_of = [&](IntegratorKind kind) {
    RenderParams params;
    params.shading = ShadingKind::path;
    params.integrator = kind;
    params.tc_rays = 2;
    params.shading_samples = 4;
    params.spp = 8;
    params.cells = Cells::off;  // which have a bias
    return test::sums_over_seeds(renderer, params, seeds, random);
  };
  test::expect_same_means(sums_of(IntegratorKind::tc), sums_of(IntegratorKind::qmc), seeds, "paths");
}

}  // namespace
}  // namespace kairos
