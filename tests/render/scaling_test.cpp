// A scene that is 2^k times as large looks the same, bit for bit.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>
#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"
#include "soup.h"

namespace kairos {
namespace {

constexpr int kPowers[] = {-100, -63, -30, -11, 0, 7, 15, 42, 100};

Vec3f scaled(Vec3f v, int k) { return {std::ldexp(v.x, k), std::ldexp(v.y, k), std::ldexp(v.z, k)}; }

std::vector<Mesh> scaled(std::vector<Mesh> meshes, int k) {
  for (Mesh& mesh : meshes)
    for (auto& key : mesh.positions)
      for (Vec3f& p : key) p = scaled(p, k);
  return meshes;
}

std::vector<Mesh> random_meshes(std::mt19937& random) {
  std::vector<Mesh> meshes;
  for (const test::Motion motion : test::kAllMotions) meshes.push_back(test::random_soup(random, motion, 12));
  meshes.push_back(test::random_soup(random, test::Motion::still, 12));
  meshes.back().positions.resize(1);
  // So small that no coordinate of the others loses a bit at 2^-100.
  for (Mesh& mesh : meshes)
    for (auto& key : mesh.positions)
      for (Vec3f& p : key)
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(p[axis]) < 1e-4f) p[axis] = 0;
  return meshes;
}

void expect_same(std::span<const Segment> a, std::span<const Segment> b, int k) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].begin, b[i].begin);
    EXPECT_EQ(a[i].end, b[i].end);
    EXPECT_EQ(std::ldexp(a[i].dist_begin, k), b[i].dist_begin);
    EXPECT_EQ(std::ldexp(a[i].dist_end, k), b[i].dist_end);
    EXPECT_EQ(a[i].mesh, b[i].mesh);
    EXPECT_EQ(a[i].triangle, b[i].triangle);
    EXPECT_EQ(a[i].front, b[i].front);
  }
}

TEST(Scaling, RaysSeeTheSameThings) {
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes = random_meshes(random);
  for (const Precision precision : {Precision::fast, Precision::exact}) {
    TracerOptions options;
    options.precision = precision;
    const Tracer tracer(meshes, options);
    Tracer::Workspace workspace, other;
    for (const int k : kPowers) {
      const Tracer large(scaled(meshes, k), options);
      size_t seen = 0;
      for (int i = 0; i < 200 && !HasFailure(); ++i) {
        const Ray ray = test::random_ray(random), same{scaled(ray.origin, k), ray.direction};
        for (const Visibility visibility : {Visibility::visible, Visibility::all}) {
          const auto segments = tracer.trace(ray, visibility, workspace);
          seen += segments.size();
          expect_same(segments, large.trace(same, visibility, other), k);
        }
        std::array<Ray, 4> packet{}, large_packet{};
        for (size_t p = 0; p < 4; ++p) {
          packet[p] = {ray.origin, ray.direction + Vec3f{0.001f * static_cast<float>(p), 0, 0}};
          large_packet[p] = {same.origin, packet[p].direction};
        }
        const auto a = tracer.trace_packet(packet, Visibility::visible, workspace);
        const auto b = large.trace_packet(large_packet, Visibility::visible, other);
        for (size_t p = 0; p < 4; ++p) expect_same(a[p].segments, b[p].segments, k);
      }
      EXPECT_GT(seen, 100u);
    }
  }
}

TEST(Scaling, DiscreteRaysHitTheSameThings) {
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes = random_meshes(random);
  const DiscreteScene scene(meshes);
  for (const int k : kPowers) {
    const DiscreteScene large(scaled(meshes, k));
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      const Ray ray = test::random_ray(random), same{scaled(ray.origin, k), ray.direction};
      const float time = std::uniform_real_distribution<float>(0, 1)(random);
      const auto a = scene.intersect(ray, time), b = large.intersect(same, time);
      ASSERT_EQ(a.has_value(), b.has_value()) << k;
      if (!a) continue;
      ++hits;
      EXPECT_EQ(std::ldexp(a->dist, k), b->dist);
      EXPECT_EQ(a->mesh, b->mesh);
      EXPECT_EQ(a->triangle, b->triangle);
      EXPECT_EQ(a->u, b->u);
      EXPECT_EQ(a->v, b->v);
      const float reach = a->dist * 0.5f;
      EXPECT_EQ(scene.intersect(ray, time, reach).has_value(),
                large.intersect(same, time, std::ldexp(reach, k)).has_value());
    }
    EXPECT_GT(hits, 100) << k;
  }
}

TEST(Scaling, DirectionsMayBeOfAnyLength) {
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes = random_meshes(random);
  for (const Precision precision : {Precision::fast, Precision::exact}) {
    TracerOptions options;
    options.precision = precision;
    const Tracer tracer(meshes, options);
    Tracer::Workspace workspace, other;
    for (int i = 0; i < 100; ++i) {
      // Components of so few bits that none is lost where the direction is denormal.
      const auto few = [&] { return static_cast<float>(std::uniform_int_distribution<int>(-16, 16)(random)) / 32; };
      const Ray ray{test::random_ray(random).origin, {few(), few(), -1}};
      for (const int k : {-140, -126, -60, 60, 120}) {
        const Ray same{ray.origin, scaled(ray.direction, k)};
        const auto a = tracer.trace(ray, Visibility::all, workspace), b = tracer.trace(same, Visibility::all, other);
        ASSERT_EQ(a.size(), b.size()) << k;
        for (size_t s = 0; s < a.size(); ++s) {
          EXPECT_EQ(a[s].begin, b[s].begin);
          EXPECT_EQ(a[s].end, b[s].end);
          EXPECT_EQ(a[s].triangle, b[s].triangle);
        }
      }
    }
  }
}

// One thing that is very far away decides nothing.
TEST(Scaling, AFarAwayTriangleChangesNothing) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes = random_meshes(random);
  const Tracer tracer(meshes);
  Mesh far;
  far.triangles = {{0, 1, 2}};
  far.positions = {{{1e30f, 1e30f, 1e30f}, {2e30f, 1e30f, 1e30f}, {1e30f, 2e30f, 1e30f}}};
  meshes.push_back(far);
  const Tracer with(meshes);
  Tracer::Workspace workspace, other;
  for (int i = 0; i < 200; ++i) {
    const Ray ray = test::random_ray(random);
    expect_same(tracer.trace(ray, Visibility::visible, workspace), with.trace(ray, Visibility::visible, other), 0);
  }
}

TEST(Scaling, PicturesAreTheSame) {
  std::mt19937 random(test::seed());
  Shot shot;
  shot.meshes = random_meshes(random);
  shot.projection.width = 24;
  shot.projection.height = 16;
  for (const bool orthographic : {false, true}) {
    shot.projection.orthographic = orthographic;
    shot.projection.view_height = 3;
    for (const auto integrator :
         {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::automatic})
      for (const auto shading : {ShadingKind::normal, ShadingKind::flat}) {
        RenderParams params;
        params.integrator = integrator;
        params.shading = shading;
        params.tc_rays = 3;
        params.spp = 12;
        params.aovs = {Aov::coverage, Aov::normal, Aov::segments, Aov::mesh};
        const Image image = render(shot, params);
        for (const int k : {-100, -13, 30, 100}) {
          Shot other = shot;
          other.meshes = scaled(shot.meshes, k);
          other.projection.view_height = std::ldexp(3.0, k);
          const Image same = render(other, params);
          ASSERT_EQ(image.channels.size(), same.channels.size());
          for (size_t c = 0; c < image.channels.size(); ++c)
            EXPECT_EQ(image.channels[c].values, same.channels[c].values)
                << image.channels[c].name << " 2^" << k << " integrator " << int(integrator) << " shading "
                << int(shading);
        }
      }
  }
}

}  // namespace
}  // namespace kairos
