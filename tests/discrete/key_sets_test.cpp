// Discrete rays against meshes of many sets of key times.
#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "discrete/discrete_scene.h"
#include "discrete/uniform_runs.h"
#include "seed.h"
#include "sliders.h"

namespace kairos {
namespace {

TEST(Discrete, MeshesWithDifferentKeysDoNotHideEachOther) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto vector = [&](float size) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    return Vec3f{size * x, size * y, size * z};
  };
  const std::vector<std::vector<float>> key_times{{0, 0.4f, 1}, {0, 0.2f, 0.4f, 0.7f, 1}, {0, 1},
                                                  {0, 0.5f, 1}, {0, 0.3f, 0.3f, 1},       {}};
  std::vector<Mesh> meshes;
  for (int m = 0; m < 12; ++m) {
    Mesh mesh;
    mesh.name = "soup";
    mesh.key_times = key_times[static_cast<size_t>(m) % key_times.size()];
    mesh.positions.resize(std::max<size_t>(1, mesh.key_times.size()));
    for (uint32_t i = 0; i < 300; ++i) {
      const Vec3f center = Vec3f{0, 0, -5} + vector(1.5f);
      const std::array<Vec3f, 3> corners{vector(0.1f), vector(0.1f), vector(0.1f)};
      for (size_t k = 0; k < mesh.positions.size(); ++k) {
        const Vec3f move = vector(0.1f);
        for (Vec3f corner : corners) mesh.positions[k].push_back(center + corner + move);
      }
      mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    meshes.push_back(mesh);
  }
  const DiscreteScene all(meshes);
  EXPECT_EQ(all.stats().trees, 6u);
  std::vector<DiscreteScene> alone;
  for (const Mesh& mesh : meshes) alone.emplace_back(std::span(&mesh, 1));
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{{}, {0.3f * uniform(random), 0.3f * uniform(random), -1}};
    const float time = std::abs(uniform(random));
    float nearest = std::numeric_limits<float>::infinity();
    for (const DiscreteScene& scene : alone)
      if (const auto hit = scene.intersect(ray, time)) nearest = std::min(nearest, hit->dist);
    const auto hit = all.intersect(ray, time);
    ASSERT_EQ(hit.has_value(), std::isfinite(nearest)) << time;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->dist, nearest, 1e-5f * nearest) << time;
  }
  EXPECT_GT(hits, 5000);
}

/// A closed surface, made of a cube's by pushing its points outwards, that turns and flies at times of its own.
Mesh make_ball(std::mt19937& random, Vec3f center, float radius, std::vector<float> times) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto vector = [&](float size) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    return Vec3f{size * x, size * y, size * z};
  };
  constexpr int kCells = 3;
  Mesh mesh;
  mesh.name = "ball";
  mesh.key_times = std::move(times);
  std::vector<Vec3f> points;
  const auto index_of = [&](Vec3f point) {
    const auto index = static_cast<size_t>(std::find(points.begin(), points.end(), point) - points.begin());
    if (index == points.size()) points.push_back(point);
    return static_cast<uint32_t>(index);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j) {
          std::array<uint32_t, 4> corners{};
          for (size_t c = 0; c < 4; ++c) {
            Vec3f point;
            point[axis] = side * kCells;
            point[(axis + 1) % 3] = static_cast<float>(2 * (i + static_cast<int>(c & 1)) - kCells);
            point[(axis + 2) % 3] = static_cast<float>(2 * (j + static_cast<int>(c >> 1)) - kCells);
            corners[c] = index_of(point);
          }
          mesh.triangles.push_back({corners[0], corners[1], corners[2]});
          mesh.triangles.push_back({corners[2], corners[1], corners[3]});
        }
  std::vector<Vec3f> moves;
  for (size_t v = 0; v < points.size(); ++v) moves.push_back(vector(0.3f * radius));
  for (size_t k = 0; k < mesh.key_times.size(); ++k) {
    const Vec3f place = center + vector(0.1f * radius);
    std::vector<Vec3f> key;
    for (size_t v = 0; v < points.size(); ++v)
      key.push_back(place + normalize(points[v]) * radius + moves[v] * uniform(random));
    mesh.positions.push_back(key);
  }
  return mesh;
}

std::vector<float> random_times(std::mt19937& random, size_t inner) {
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> times{0, 1};
  for (size_t i = 0; i < inner; ++i) times.push_back(uniform(random));
  std::sort(times.begin(), times.end());
  return times;
}

TEST(Discrete, FromWithinClosedSurfacesOfManyKeySets) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Mesh> balls;
  for (int b = 0; b < 24; ++b)
    balls.push_back(make_ball(random, {40.0f * static_cast<float>(b), 0, -5}, 2, random_times(random, 1 + b % 5)));
  const DiscreteScene scene(balls);
  std::vector<Ray> rays;
  std::vector<float> times;
  for (size_t b = 0; b < balls.size(); ++b)
    for (int i = 0; i < 500; ++i) {
      rays.push_back({{40.0f * static_cast<float>(b), 0, -5}, {uniform(random), uniform(random), uniform(random)}});
      times.push_back(std::abs(uniform(random)));
      // Between two points of an edge at a key: where neither triangle may leave it to the other.
      const Mesh& ball = balls[b];
      const auto key = static_cast<size_t>(random() % ball.key_count());
      const Triangle& triangle = ball.triangles[random() % ball.triangles.size()];
      const Vec3f on_edge =
          lerp(ball.positions[key][triangle[0]], ball.positions[key][triangle[1]], std::abs(uniform(random)));
      rays.push_back({rays.back().origin, on_edge - rays.back().origin});
      times.push_back(ball.key_times[key]);
    }
  std::vector<std::optional<DiscreteHit>> hits(rays.size());
  scene.intersect(rays, times, hits);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_TRUE(hits[i]) << "ray " << i << " leaves ball " << i / 1000 << " at " << times[i];
    ASSERT_EQ(hits[i]->mesh, i / 1000);
    EXPECT_FALSE(scene.intersect(rays[i], times[i], 0.99f * hits[i]->dist)) << "looks farther than asked";
  }
}

TEST(Discrete, AThousandKeySetsAreFewTrees) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Mesh> one_set, many_sets;
  for (int m = 0; m < 1024; ++m) {
    const float x = 3 * uniform(random), way = 0.3f * uniform(random), depth = -5 + uniform(random);
    const std::vector<float> times = random_times(random, 1);
    many_sets.push_back(make_slider(times, {x, x + way * times[1], x + way}, depth));
    one_set.push_back(make_slider({0, 1}, {x, x + way}, depth));  // the same motion
  }
  const DiscreteScene one(one_set), many(many_sets);
  EXPECT_EQ(one.stats().trees, 1u);
  EXPECT_LE(many.stats().trees, 4 * 2 + 1u);
  EXPECT_LT(static_cast<double>(many.memory_bytes()), 2.0 * static_cast<double>(one.memory_bytes()));
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{{4 * uniform(random), uniform(random), 5}, {0.1f * uniform(random), 0, -2}};
    const float time = std::abs(uniform(random));
    const auto expected = one.intersect(ray, time), got = many.intersect(ray, time);
    if (expected.has_value() != got.has_value() || (got && got->mesh != expected->mesh)) {
      // Rounding decides at an edge, and where two are equally far.
      if (got && expected && std::abs(got->dist - expected->dist) < 1e-5f * got->dist) continue;
      const auto aside = one.intersect({ray.origin + Vec3f{1e-5f, 0, 0}, ray.direction}, time);
      const auto other = one.intersect({ray.origin - Vec3f{1e-5f, 0, 0}, ray.direction}, time);
      ASSERT_TRUE(aside.has_value() != other.has_value() || (aside && aside->mesh != other->mesh)) << "ray " << i;
      continue;
    }
    if (!got) continue;
    ++hits;
    EXPECT_NEAR(got->dist, expected->dist, 1e-5f * got->dist);
    EXPECT_NEAR(got->u, expected->u, 1e-4f);
    EXPECT_NEAR(got->v, expected->v, 1e-4f);
    EXPECT_EQ(got->front, expected->front);
  }
  EXPECT_GT(hits, 5000);
}

TEST(Discrete, UniformRuns) {
  const auto runs = [](std::vector<float> times, size_t most) {
    std::vector<std::pair<size_t, size_t>> out;
    for (const UniformRun& run : uniform_runs(times, most)) out.emplace_back(run.first, run.last);
    return out;
  };
  using Runs = std::vector<std::pair<size_t, size_t>>;
  EXPECT_EQ(runs({0, 1}, 129), (Runs{{0, 1}}));
  EXPECT_EQ(runs({0, 0.25f, 0.5f, 0.75f, 1}, 129), (Runs{{0, 4}}));
  EXPECT_EQ(runs({0, 0.25f, 0.5f, 0.75f, 1}, 3), (Runs{{0, 2}, {2, 4}}));
  EXPECT_EQ(runs({0, 0.1f, 0.2f, 0.6f, 1}, 129), (Runs{{0, 2}, {2, 4}}));
  EXPECT_EQ(runs({0, 0.5f, 0.5f, 1}, 129), (Runs{{0, 1}, {2, 3}}));
  EXPECT_EQ(runs({0, 0, 1, 1}, 129), (Runs{{1, 2}}));
}

}  // namespace
}  // namespace kairos
