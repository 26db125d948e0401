// Lights chosen by what they are worth, against sums and integrals of all of them.
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "discrete/discrete_scene.h"
#include "seed.h"
#include "shading/microfacets.h"
#include "shading/reflectance.h"
#include "shading/shader.h"
#include "shading/shadow_rays.h"
#include "shading/spherical_triangle.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

/// Mean of many shading samples of what a ray sees, its standard error, and the relative deviation of a single sample.
struct Estimate {
  double mean = 0, error = 0, deviation = 0;
};

Estimate estimate(const Shot& shot, const Ray& ray, float time = 0.5f) {
  const DiscreteOptions options{true, nullptr, 0, panes_of(shot)};
  const auto scene = std::make_shared<const DiscreteScene>(shot.meshes, options);
  const Shader shader(shot, ShadingKind::whitted, false, 8, scene);
  const auto hit = scene->intersect(ray, time);
  if (!hit) {
    ADD_FAILURE() << "the ray sees nothing";
    return {};
  }
  // Samples of one seed are spread evenly; means of seeds are independent.
  constexpr uint32_t kSeeds = 128, kSamples = 32;
  static std::mt19937_64 random(test::seed());
  double sum = 0, squares = 0, single_squares = 0;
  for (uint32_t s = 0; s < kSeeds; ++s) {
    const uint64_t seed = random();
    double of_seed = 0;
    for (uint32_t i = 0; i < kSamples; ++i) {
      const double value = static_cast<double>(shader.shade(ray, hit->mesh, hit->triangle, time, {seed, i}).colour.x);
      of_seed += value / kSamples;
      single_squares += value * value;
    }
    sum += of_seed;
    squares += of_seed * of_seed;
  }
  const double mean = sum / kSeeds, variance = std::max(0.0, squares / kSeeds - mean * mean) / (kSeeds - 1);
  const double single = std::max(0.0, single_squares / (kSeeds * kSamples) - mean * mean);
  return {mean, std::sqrt(variance), std::sqrt(single) / mean};
}

/// Five standard errors, of which about one in a million tests strays so far; and what floats round.
void expect_mean(const Estimate& estimate, double expected) {
  EXPECT_NEAR(estimate.mean, expected, 5 * estimate.error + 2e-5 * expected);
  EXPECT_LT(estimate.error, 0.02 * expected) << "too noisy to say anything";
}

const Mesh kGround = parallelogram({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, 0);
const Ray kToGround{{0, 0, 0}, {1, -1, -2}};  // meets it at (1, -1, -2)

Shot ground_shot() {
  Shot shot;
  shot.meshes = {kGround};
  shot.materials = {lambert({1, 1, 1})};
  return shot;
}

/// A rectangle that faces down, of 2 x n x n triangles; it slides by `slide` while the shutter is open.
Mesh ceiling(Vec3f corner, float width, float depth, uint32_t n, Vec3f slide = {}) {
  Mesh mesh;
  mesh.positions.resize(1);
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i)
      mesh.positions[0].push_back(corner + Vec3f{width * static_cast<float>(i) / static_cast<float>(n), 0,
                                                 depth * static_cast<float>(j) / static_cast<float>(n)});
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  mesh.material = 1;
  if (slide == Vec3f{}) return mesh;
  mesh.key_times = {0, 1};
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions[1]) p += slide;
  return mesh;
}

/// Form factor of a rectangle parallel to the ground, `height` above a point: of corners (x, z) relative to it.
double ceiling_factor(double x0, double x1, double z0, double z1, double height) {
  const auto quarter = [&](double a, double b) {  // from above the point to (a, b): J. Howell, C-4
    const double x = a / height, y = b / height, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * M_PI);
  };
  return quarter(x1, z1) - quarter(x0, z1) - quarter(x1, z0) + quarter(x0, z0);
}

TEST(ManyLights, DirectionsToATriangleAreSpreadEvenly) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1), unit(0, 1);
  for (int i = 0; i < 20; ++i) {
    std::array<Vec3d, 3> corners;
    for (Vec3d& corner : corners) corner = {uniform(random), uniform(random), 0.2 + unit(random)};
    const double solid = solid_angle(corners);
    if (solid < 0.05) continue;
    // The mean cosine with the axis is Lambert's formula for the polygon over its solid angle.
    double lambert = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d a = normalize(corners[k]), b = normalize(corners[(k + 1) % 3]);
      lambert += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * normalize(cross(a, b)).z / 2;
    }
    constexpr int kGrid = 64;  // midpoints: the integrand is smooth
    double mean = 0;
    for (int u = 0; u < kGrid; ++u)
      for (int v = 0; v < kGrid; ++v)
        mean += spherical_triangle_direction(corners, solid, (u + 0.5) / kGrid, (v + 0.5) / kGrid).z / (kGrid * kGrid);
    EXPECT_NEAR(mean * solid, std::abs(lambert), 2e-3 * solid);
  }
}

TEST(ManyLights, TenThousandTrianglesShineLikeOneSquare) {
  Shot shot = ground_shot();
  shot.materials.push_back(lamp({3, 3, 3}));
  shot.meshes.push_back(ceiling({-59, 1, -62}, 120, 120, 71));  // 2 above (1, -1, -2), centred there
  const Estimate still = estimate(shot, kToGround);
  expect_mean(still, 3 * ceiling_factor(-60, 60, -60, 60, 2));
  // By power and area most samples would go far away: their deviation is 19 times the mean.
  EXPECT_LT(still.deviation, 2.5);
  // It is where it is at the sample's time.
  shot.meshes.back() = ceiling({-59, 1, -62}, 20, 120, 71, {100, 0, 0});
  for (const float time : {0.1f, 0.5f, 0.75f})
    expect_mean(estimate(shot, kToGround, time), 3 * ceiling_factor(-60 + 100 * static_cast<double>(time),
                                                                    -40 + 100 * static_cast<double>(time), -60, 60, 2));
}

/// What falls on a white point that faces up, over pi, by the way of old: a triangle by its power, a place by area.
Estimate by_power(const Shot& shot, const DiscreteScene& scene, Vec3d point, std::mt19937& random) {
  struct Triangle {
    std::array<Vec3d, 3> corners;
    double radiance, area;
  };
  std::vector<Triangle> triangles;
  std::vector<double> powers;
  for (const Mesh& mesh : shot.meshes)
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      const auto radiance = static_cast<double>(shot.materials[mesh.material].emission.x);
      const std::array<Vec3d, 3> corners = triangle_at(mesh, t, 0);
      const double area = length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
      if (radiance > 0) triangles.push_back({corners, radiance, area});
      if (radiance > 0) powers.push_back(radiance * area);
    }
  const double all = std::accumulate(powers.begin(), powers.end(), 0.0);
  std::discrete_distribution<size_t> choose(powers.begin(), powers.end());
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kSamples = 10000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto& [corners, radiance, area] = triangles[choose(random)];
    const double u = std::sqrt(unit(random)), v = unit(random);
    const Vec3d place = corners[0] * (1 - u) + corners[1] * (u * (1 - v)) + corners[2] * (u * v);
    const Vec3d from = point + Vec3d{0, 1e-4, 0}, way = place - from, direction = normalize(way);
    const Vec3d face = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    const double squared = dot(way, way), cosines = direction.y * std::abs(dot(face, direction));
    if (!(direction.y > 0) ||
        scene.occluded({to_float(from), to_float(direction)}, 0, static_cast<float>(std::sqrt(squared) * 0.9999)))
      continue;
    const double value = cosines / squared / M_PI * all;  // radiance over the density, radiance / all
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kSamples;
  return {mean, std::sqrt(std::max(0.0, squares / kSamples - mean * mean) / kSamples), 0};
}

TEST(ManyLights, ByPowerAndByWorthTheMeanIsTheSame) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> number(-1, 1);
  const auto any = [&](float size) {
    return Vec3f{size * number(random), size * number(random), size * number(random)};
  };
  Shot shot = ground_shot();
  for (uint32_t i = 1; i <= 12; ++i) {
    const float bright = 5 + 4 * number(random);
    shot.materials.push_back(lamp({bright, bright, bright}));
    shot.meshes.push_back(parallelogram(Vec3f{0, 2, -4} + any(2), any(0.6f), any(0.6f), i));
  }
  for (int i = 0; i < 6; ++i) {  // in the way of some
    const Vec3f corner = Vec3f{0, 0, -4} + any(1.5f);
    shot.meshes.push_back(box({corner.x, -0.5f, corner.z}, {corner.x + 0.4f, 0, corner.z + 0.4f}, 0));
  }
  const DiscreteScene scene(shot.meshes);
  double squares = 0, difference = 0, variance = 0;
  constexpr int kPoints = 16;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3f point{2 * number(random), -1, -4 + 2 * number(random)};
    const Estimate worth = estimate(shot, {{point.x, -0.95f, point.z}, {0, -1, 0}});
    const Estimate power = by_power(shot, scene, to_double(point), random);
    const double apart = worth.mean - power.mean, both = std::hypot(worth.error, power.error);
    squares += apart * apart / (both * both) / kPoints;
    difference += apart;
    variance += both * both;
  }
  EXPECT_LT(squares, 3.5) << "1 for what differs by noise alone";
  EXPECT_LT(std::abs(difference), 5 * std::sqrt(variance));
}

TEST(ManyLights, AStreetOfLamps) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(0, 1);
  Shot shot = ground_shot();
  double expected = 0;
  const Vec3d point{1, -1, -2};
  for (int i = 0; i < 500; ++i) {
    const Vec3f place{static_cast<float>(i) - 250, 2 + uniform(random), i % 2 == 0 ? 1.5f : -6.0f};
    const float intensity = 1 + 5 * uniform(random);
    Light light = PointLight{place, {intensity, intensity, intensity}};
    std::function<Light(double)> moving;
    Vec3d there = to_double(place);
    if (i % 5 == 0) {  // a car's
      moving = [=](double time) {
        return PointLight{place + Vec3f{static_cast<float>(20 * time), 0, 0}, {intensity, intensity, intensity}};
      };
      there.x += 10;  // halfway through
    }
    double cone = 1;
    if (i % 3 == 0) {
      light = SpotLight{place, {0, -1, 0}, {intensity, intensity, intensity}, 0.9f, 0.6f};
      moving = nullptr;
      there = to_double(place);
    }
    const Vec3d way = there - point;
    const double squared = dot(way, way), cosine = way.y / std::sqrt(squared);
    if (i % 3 == 0) cone = std::pow(std::clamp((cosine - 0.6) / 0.3, 0.0, 1.0), 2);
    expected += static_cast<double>(intensity) * cone * cosine / squared / M_PI;
    shot.lights.push_back(light);
    shot.moving_lights.push_back(moving);
  }
  const Estimate lit = estimate(shot, kToGround);
  expect_mean(lit, expected);
  EXPECT_LT(lit.deviation, 1.5) << "lamps near by are no likelier than those far away";
}

/// A lamp in a glossy floor: what is looked for at the lamp and where the highlight is, weighed together.
TEST(ManyLights, HighlightsOfAreaLightsAreIntegrals) {
  for (const float roughness : {0.25f, 0.4f, 0.8f}) {
    Shot shot = ground_shot();
    shot.materials[0] = lambert({0.8f, 0.8f, 0.8f});
    shot.materials[0].metallic = 1;
    shot.materials[0].roughness = roughness;
    shot.materials.push_back(lamp({3, 3, 3}));
    shot.meshes.push_back(ceiling({1.5f, 0, -4.5f}, 1, 1.5f, 1));  // 1 above, where the ray is mirrored to
    const Vec3d point{1, -1, -2}, normal{0, 1, 0}, to_viewer = normalize(Vec3d{-1, 1, 2});
    const Reflectance shares =
        reflectance(shot.materials[0], {{0.8f, 0.8f, 0.8f}, {}, 1, 1, roughness}, dot(normal, to_viewer), true);
    double expected = 0;
    constexpr int kGrid = 256;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const Vec3d place{1.5 + (i + 0.5) / kGrid, 0, -4.5 + 1.5 * (j + 0.5) / kGrid}, way = place - point;
        const double squared = dot(way, way), cosine = way.y / std::sqrt(squared);
        const double scattered =
            static_cast<double>(shares.diffuse.x) / M_PI +
            static_cast<double>(shares.highlight.x) * highlight_lobe(normal, to_viewer, normalize(way), shares.alpha);
        expected += 3 * scattered * cosine * cosine / squared * 1.5 / (kGrid * kGrid);
      }
    const Estimate lit = estimate(shot, kToGround);
    expect_mean(lit, expected);
    EXPECT_LT(lit.deviation, 1.2) << roughness;
  }
}

}  // namespace
}  // namespace kairos
