// One-sided meshes: there only while they turn their front to who looks, or to the light.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "soup.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

/// A triangle whose edges from its top, which stands still, pass the ray kAhead: the left one at time 1 / left, the
/// right one at 1 / right. Its front is seen before, its back after both.
Mesh turning(float left, float right) {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 1};
  mesh.positions = {{{-1, -1, -5}, {1, -1, -5}, {0, 1, -5}}, {{left - 1, -1, -4}, {1 - right, -1, -6}, {0, 1, -5}}};
  return mesh;
}
constexpr Ray kAhead{{0, -0.5f, 0}, {0, 0, -1}};

Mesh turned_round(Mesh mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}
Mesh one_sided(Mesh mesh) {
  mesh.one_sided = true;
  return mesh;
}
Mesh wall(float z) { return parallelogram({-20, -20, z}, {40, 0, 0}, {0, 40, 0}, 0); }

std::vector<Segment> trace(const Tracer& tracer, const Ray& ray, Visibility visibility) {
  Tracer::Workspace workspace;
  const auto seen = tracer.trace(ray, visibility, workspace);
  return {seen.begin(), seen.end()};
}

class FacingOf : public testing::TestWithParam<InstructionSet> {};

TEST_P(FacingOf, ATurningTriangleIsSeenUntilItsFrontIsAway) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> speed(1.25f, 4);
  for (int round = 0; round < 100; ++round) {
    const float left = speed(random), right = speed(random);
    const float front_until = 1 / std::max(left, right), back_from = 1 / std::min(left, right);
    for (const Precision precision : {Precision::fast, Precision::exact}) {
      const TracerOptions options{precision, GetParam()};
      const Mesh mesh = one_sided(turning(left, right));
      // Ends at which the wall behind takes over: of the front, or (turned round) of the back.
      for (const bool is_back : {false, true}) {
        const std::vector<Mesh> meshes{is_back ? turned_round(mesh) : mesh, wall(-9)};
        const Tracer tracer(meshes, options);
        const auto expect = [&](std::span<const Segment> seen) {
          ASSERT_EQ(seen.size(), 2u) << left << " " << right;
          const float change = is_back ? back_from : front_until;
          EXPECT_EQ(seen[is_back ? 1 : 0].mesh, 0u);
          EXPECT_TRUE(seen[is_back ? 1 : 0].front);
          EXPECT_NEAR(seen[0].end, change, 1e-5);
          EXPECT_EQ(seen[1].begin, seen[0].end);
          EXPECT_EQ(seen[1].end, 1);
        };
        expect(trace(tracer, kAhead, Visibility::visible));
        const std::vector<Ray> rays(5, kAhead);
        Tracer::Workspace workspace;
        for (const SeenByRay& seen : tracer.trace_packet(rays, Visibility::visible, workspace)) expect(seen.segments);
      }
    }
  }
}

/// Soups that move, and one that stands still, every second of them one-sided.
std::vector<Mesh> soups(std::mt19937& random) {
  std::vector<Mesh> meshes;
  for (const test::Motion motion : test::kAllMotions) meshes.push_back(test::random_soup(random, motion, 30));
  meshes.push_back(test::random_soup(random, test::Motion::still, 30));
  meshes.back().positions.resize(1);
  for (size_t m = 0; m < meshes.size(); m += 2) meshes[m].one_sided = true;
  return meshes;
}

TEST_P(FacingOf, OneSidedMeshesAreMetWhereTheirFrontsAreAndNowhereElse) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const std::vector<Mesh> meshes = soups(random);
  std::vector<Mesh> two_sided = meshes;
  for (Mesh& mesh : two_sided) mesh.one_sided = false;
  const Tracer some(meshes, {Precision::fast, GetParam()}), whole(two_sided, {Precision::fast, GetParam()});
  size_t dropped = 0;
  for (int r = 0; r < 300; ++r) {
    const Ray ray = test::random_ray(random);
    const auto got = trace(some, ray, Visibility::all);
    size_t next = 0;
    for (const Segment& hit : trace(whole, ray, Visibility::all)) {
      if (!hit.front && meshes[hit.mesh].one_sided) {
        ++dropped;
        continue;
      }
      ASSERT_LT(next, got.size()) << "seed " << seed;
      EXPECT_EQ(got[next].begin, hit.begin);
      EXPECT_EQ(got[next].end, hit.end);
      EXPECT_EQ(got[next].mesh, hit.mesh);
      EXPECT_EQ(got[next].triangle, hit.triangle);
      ++next;
    }
    EXPECT_EQ(next, got.size());
  }
  EXPECT_GT(dropped, 300u);
}

TEST_P(FacingOf, DiscreteRaysSeeTheSameAtAlmostAllInstants) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const std::vector<Mesh> meshes = soups(random);
  const Tracer tracer(meshes, {Precision::exact, GetParam()});
  const DiscreteScene scene(meshes);
  size_t instants = 0, agree = 0, packets_agree = 0;
  const auto is = [](const std::optional<DiscreteHit>& hit, const Segment* segment) {
    if (!hit || segment == nullptr) return !hit && segment == nullptr;
    return hit->mesh == segment->mesh && hit->triangle == segment->triangle && hit->front == segment->front;
  };
  for (int r = 0; r < 300; ++r) {
    const Ray ray = test::random_ray(random);
    const auto seen = trace(tracer, ray, Visibility::visible);
    std::vector<float> times;
    for (int k = 0; k < 32; ++k) times.push_back((static_cast<float>(k) + 0.5f) / 32);
    const std::vector<Ray> rays(times.size(), ray);
    std::vector<std::optional<DiscreteHit>> hits(times.size());
    scene.intersect(rays, times, hits);
    for (size_t k = 0; k < times.size(); ++k) {
      const auto there = std::find_if(seen.begin(), seen.end(),
                                      [&](const Segment& s) { return s.begin <= times[k] && times[k] < s.end; });
      const Segment* segment = there == seen.end() ? nullptr : &*there;
      ++instants;
      agree += is(scene.intersect(ray, times[k]), segment);
      packets_agree += is(hits[k], segment);
    }
  }
  EXPECT_GE(static_cast<double>(agree), 0.995 * static_cast<double>(instants)) << "seed " << seed;
  EXPECT_GE(static_cast<double>(packets_agree), 0.995 * static_cast<double>(instants)) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(All, FacingOf,
                         testing::ValuesIn(supported_instruction_sets().begin(), supported_instruction_sets().end()),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

TEST(Facing, LightMeetsFrontsThatAreTurnedToIt) {
  const std::vector<Mesh> meshes{one_sided(turning(2, 2))};
  const DiscreteScene scene(meshes);
  EXPECT_TRUE(scene.intersect(kAhead, 0.25f));
  EXPECT_FALSE(scene.intersect(kAhead, 0.75f));
  EXPECT_FALSE(scene.intersect(kAhead, 0.25f, 9, Facing::far_end));
  EXPECT_TRUE(scene.intersect(kAhead, 0.75f, 9, Facing::far_end));
}

/// What one small pixel that looks along -z sees.
Vec3f seen(Shot shot, ShadingKind shading, IntegratorKind integrator, int rays = 256) {
  shot.projection.width = shot.projection.height = 1;
  shot.projection.orthographic = true;
  shot.projection.view_height = 1e-3;
  RenderParams params;
  params.shading = shading;
  params.integrator = integrator;
  params.spp = params.tc_rays = rays;
  const Image image = render(shot, params);
  return {image.find("R")->values[0], image.find("G")->values[0], image.find("B")->values[0]};
}
constexpr IntegratorKind kIntegrators[] = {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed,
                                           IntegratorKind::automatic};

/// A red cube in a black hull that is turned inside out, as characters get outlines.
Shot outlined(bool hull_moves) {
  Shot shot;
  shot.materials = {lambert({1, 0, 0}), lambert({0, 0, 0})};
  shot.meshes = {box({-1, -1, -6}, {1, 1, -4}, 0),
                 one_sided(turned_round(box({-1.1f, -1.1f, -6.1f}, {1.1f, 1.1f, -3.9f}, 1)))};
  if (hull_moves) {
    Mesh& hull = shot.meshes[1];
    hull.key_times = {0, 1};
    hull.positions.push_back(hull.positions[0]);
    for (Vec3f& p : hull.positions[1]) p.x += 0.05f;
  }
  return shot;
}

TEST(Facing, AHullTurnedInsideOutHidesNothingOfWhatItOutlines) {
  for (const bool moves : {false, true})
    for (const IntegratorKind integrator : kIntegrators)
      EXPECT_EQ(seen(outlined(moves), ShadingKind::flat, integrator).x, 1) << moves << static_cast<int>(integrator);
}

TEST(Facing, NorDoesItKeepLightFromIt) {
  for (const bool moves : {false, true})
    for (const IntegratorKind integrator : kIntegrators) {
      Shot shot = outlined(moves);
      shot.lights = {DirectionalLight{{0, 0, -1}, {M_PI, M_PI, M_PI}}};
      EXPECT_NEAR(seen(shot, ShadingKind::whitted, integrator).x, 1, 1e-4) << moves << static_cast<int>(integrator);
      shot.meshes[1] = turned_round(shot.meshes[1]);  // a box in a box is dark, and black from outside
      EXPECT_EQ(seen(shot, ShadingKind::whitted, integrator).x, 0);
    }
}

TEST(Facing, ALampShinesFromItsFront) {
  Shot shot;
  shot.materials = {lambert({1, 1, 1}), lamp({1, 1, 1})};
  // The lamp lies behind the camera and looks at what it looks at.
  shot.meshes = {wall(-3), one_sided(parallelogram({1, -1, 2}, {-2, 0, 0}, {0, 2, 0}, 1))};
  const float lit = seen(shot, ShadingKind::whitted, IntegratorKind::qmc, 4096).x;
  // The form factor of a square of 2 x 2 from 5 away, over its middle.
  const double a = 1 / std::sqrt(26.0), factor = 4 / M_PI * a * std::atan(a);
  EXPECT_NEAR(lit, factor, 0.01 * factor);
  shot.meshes[1] = turned_round(shot.meshes[1]);
  EXPECT_EQ(seen(shot, ShadingKind::whitted, IntegratorKind::qmc).x, 0);
}

}  // namespace
}  // namespace kairos
