// Discrete rays against moving triangles whose answers are known.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "discrete/discrete_scene.h"
#include "discrete/uniform_runs.h"
#include "soup.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kairos {
namespace {

/// A triangle in the plane z = `depth` around (x, 0), counter-clockwise seen from +z: 1 wide at y = 0, up to y = 1.
std::vector<Vec3f> triangle_at(float x, float depth) {
  return {{x - 0.5f, -1, depth}, {x + 0.5f, -1, depth}, {x, 1, depth}};
}

/// A triangle that is at xs[k] at time times[k].
Mesh make_slider(std::vector<float> times, const std::vector<float>& xs, float depth) {
  Mesh mesh;
  mesh.name = "slider";
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = std::move(times);
  for (float x : xs) mesh.positions.push_back(triangle_at(x, depth));
  return mesh;
}

/// At y = 0 the triangle is half a unit wide: it covers the ray at x where |x - its place| < 1/4.
constexpr float kReach = 0.25f;
Ray ray_at(float x) { return {{x, 0, 5}, {0, 0, -2}}; }

TEST(Discrete, HitsWhileTheTriangleIsThere) {
  const std::vector<Mesh> meshes{make_slider({0, 1}, {-1, 1}, -5)};
  const DiscreteScene scene(meshes);
  for (float x : {-0.5f, 0.0f, 0.4f})
    for (int i = 0; i <= 1000; ++i) {
      const float time = static_cast<float>(i) / 1000, place = 2 * time - 1;
      if (std::abs(std::abs(x - place) - kReach) < 1e-5f) continue;
      const auto hit = scene.intersect(ray_at(x), time);
      ASSERT_EQ(hit.has_value(), std::abs(x - place) < kReach) << x << " " << time;
      if (!hit) continue;
      EXPECT_FLOAT_EQ(hit->dist, 5);
      EXPECT_TRUE(hit->front);
      // (1-u-v) p0 + u p1 + v p2
      EXPECT_NEAR(place - 0.5f + hit->u + 0.5f * hit->v, x, 1e-5);
      EXPECT_NEAR(-1 + 2 * hit->v, 0, 1e-5);
    }
}

TEST(Discrete, MoreKeysAreTheSameMotion) {
  // Even keys, uneven ones (two stretches), and a jump.
  const std::vector<Mesh> meshes{make_slider({0, 0.5f, 1}, {-1, 1, 0.5f}, -5),
                                 make_slider({0, 0.25f, 1}, {2, 3, 2.5f}, -6),
                                 make_slider({0, 0.5f, 0.5f, 1}, {-3, -2, -4, -3}, -7)};
  const DiscreteScene scene(meshes);
  EXPECT_EQ(scene.stats().moving_keys, 3u + 2 + 2 + 2 + 2);
  for (const auto& [keys, all] : {std::pair{2, 11u}, {4, 5u + 4 * 4}, {9, 9u + 4 * 9}, {129, 129u + 4 * 129}}) {
    const DiscreteScene finer(meshes, {true, nullptr, keys});
    EXPECT_EQ(finer.stats().moving_keys, all) << keys;
    for (int i = 0; i <= 500; ++i)
      for (int j = 0; j <= 60; ++j) {
        const float time = static_cast<float>(i) / 500, x = -4.5f + 0.13717f * static_cast<float>(j);
        const auto expected = scene.intersect(ray_at(x), time), got = finer.intersect(ray_at(x), time);
        ASSERT_EQ(expected.has_value(), got.has_value()) << keys << " keys, " << x << " " << time;
        if (!expected) continue;
        EXPECT_EQ(expected->mesh, got->mesh);
        EXPECT_NEAR(expected->u, got->u, 1e-5);
        EXPECT_FLOAT_EQ(expected->dist, got->dist);
      }
  }
  EXPECT_EQ(DiscreteScene(std::vector<Mesh>{make_slider({}, {0}, -5)}, {true, nullptr, 9}).stats().moving_keys, 0u);
}

TEST(Discrete, FacingAndNumbers) {
  std::vector<Mesh> meshes(3, make_slider({0, 1}, {0, 0.1f}, -5));
  meshes[0].triangles.clear();
  meshes[1].triangles = {{0, 2, 1}};
  meshes[1].positions = {triangle_at(0, -4)};
  meshes[2].triangles = {{0, 0, 0}, {0, 1, 2}};
  const DiscreteScene scene(meshes);
  const auto from_front = scene.intersect(ray_at(0), 0.5f);
  ASSERT_TRUE(from_front);
  EXPECT_EQ(from_front->mesh, 1u);
  EXPECT_EQ(from_front->triangle, 0u);
  EXPECT_FALSE(from_front->front) << "wound the other way";
  EXPECT_FLOAT_EQ(from_front->dist, 4.5f);
  const auto from_behind = scene.intersect({{0, 0, -9}, {0, 0, 1}}, 0.5f);
  ASSERT_TRUE(from_behind);
  EXPECT_EQ(from_behind->mesh, 2u);
  EXPECT_EQ(from_behind->triangle, 1u);
  EXPECT_FALSE(from_behind->front);
  EXPECT_EQ(scene.stats().static_geometries, 1u);
  EXPECT_EQ(scene.stats().moving_geometries, 1u);
  EXPECT_EQ(scene.stats().triangles, 3u);
  EXPECT_GT(scene.memory_bytes(), 100u);
}

TEST(Discrete, MovingBeforeStillAndBehindIt) {
  std::vector<Mesh> meshes{make_slider({0, 1}, {-1, 1}, -5), make_slider({}, {0}, -4),
                           make_slider({0, 1}, {1, -1}, -3)};
  const DiscreteScene scene(meshes);
  EXPECT_EQ(scene.intersect(ray_at(0), 0.5f)->mesh, 2u);
  EXPECT_EQ(scene.intersect(ray_at(0), 0.9f)->mesh, 1u);
  EXPECT_EQ(scene.intersect(ray_at(-0.8f), 0.1f)->mesh, 0u);
  EXPECT_FALSE(scene.intersect(ray_at(-0.8f), 0.5f));
}

/// Meshes far away, of more triangles and with key times that `mesh` does not have: `mesh` has to share an Embree
/// scene.
std::vector<Mesh> in_a_crowd(const Mesh& mesh) {
  std::vector<Mesh> meshes{mesh};
  for (const float time : {0.11f, 0.22f, 0.33f, 0.44f, 0.66f}) {
    meshes.push_back(make_slider({0, time, 1}, {1000, 1001, 1002}, -5));
    meshes.back().triangles.resize(3, {0, 1, 2});
  }
  return meshes;
}

/// Where the mesh is, and whether a ray there and 0.3 to both sides of it hits, at many times with the keys among them.
void expect_follows(const std::vector<Mesh>& meshes, const std::vector<float>& xs) {
  const Mesh& mesh = meshes.front();
  const DiscreteScene scene(meshes);
  std::vector<float> instants = mesh.key_times;
  for (float key : mesh.key_times)
    for (float neighbour : {std::nextafter(key, 0.0f), std::nextafter(key, 1.0f)}) instants.push_back(neighbour);
  for (int i = 0; i <= 2000; ++i) instants.push_back(static_cast<float>(i) / 2000);
  for (float time : instants) {
    size_t k = 0;
    while (k + 2 < xs.size() && time >= mesh.key_times[k + 1] && mesh.key_times[k + 1] < 1) ++k;
    const float begin = mesh.key_times[k], end = mesh.key_times[k + 1];
    const float x = xs[k] + (xs[k + 1] - xs[k]) * (end > begin ? (time - begin) / (end - begin) : 1);
    EXPECT_TRUE(scene.intersect(ray_at(x), time)) << time;
    EXPECT_TRUE(scene.intersect(ray_at(x + 0.95f * kReach), time)) << time;
    EXPECT_FALSE(scene.intersect(ray_at(x + 1.05f * kReach), time)) << time;
    EXPECT_FALSE(scene.intersect(ray_at(x - 1.05f * kReach), time)) << time;
  }
  for (size_t k = 0; k + 1 < xs.size(); ++k)  // gone from where it jumps away
    if (mesh.key_times[k] == mesh.key_times[k + 1] && mesh.key_times[k] < 1) {
      EXPECT_FALSE(scene.intersect(ray_at(xs[k]), mesh.key_times[k]));
    }
}

void expect_follows(const Mesh& mesh, const std::vector<float>& xs) {
  expect_follows(std::vector{mesh}, xs);
  expect_follows(in_a_crowd(mesh), xs);
}

TEST(Discrete, EvenKeys) {
  expect_follows(make_slider({0, 0.25f, 0.5f, 0.75f, 1}, {0, 2, 1, -3, 1}, -5), {0, 2, 1, -3, 1});
}

TEST(Discrete, UnevenKeys) {
  expect_follows(make_slider({0, 0.1f, 0.5f, 0.55f, 1}, {0, 2, 1, -3, 1}, -5), {0, 2, 1, -3, 1});
}

TEST(Discrete, Jump) {
  const std::vector<float> xs{0, 0.5f, 4, 3.5f, -2, -2.5f};
  expect_follows(make_slider({0, 0.3f, 0.3f, 0.5f, 0.5f, 1}, xs, -5), xs);
  // At the shutter's ends; when it closes the mesh is where it was until then.
  expect_follows(make_slider({0, 0, 1, 1}, {-4, 0, 1, 5}, -5), {-4, 0, 1, 5});
}

TEST(Discrete, MoreKeysThanEmbreeTakes) {
  constexpr size_t kKeys = 1000;
  std::vector<float> times, xs;
  for (size_t k = 0; k < kKeys; ++k) {
    times.push_back(static_cast<float>(k) / (kKeys - 1));
    xs.push_back(k % 2 ? 0.01f : -0.01f);
  }
  expect_follows(make_slider(times, xs, -5), xs);
}

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
      // Rounding decides at an edge.
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

TEST(Discrete, PacketsAgreeWithSingleRays) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  Mesh soup;
  soup.name = "soup";
  soup.key_times = {0, 0.5f, 1};
  soup.positions.resize(3);
  for (uint32_t i = 0; i < 100; ++i) {
    for (auto& key : soup.positions)
      for (int v = 0; v < 3; ++v) key.push_back({2 * uniform(random), 2 * uniform(random), -4 + uniform(random)});
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const std::vector<Mesh> meshes{soup, make_slider({}, {0}, -4)};
  const DiscreteScene scene(meshes);
  std::vector<Ray> rays;
  std::vector<float> times;
  for (int i = 0; i < 1003; ++i) {
    rays.push_back({{}, {0.4f * uniform(random), 0.4f * uniform(random), -1}});
    times.push_back(std::abs(uniform(random)));
  }
  rays[5].direction = {};
  rays[6].origin.x = std::numeric_limits<float>::quiet_NaN();
  rays[7].direction.y = std::numeric_limits<float>::infinity();
  times[8] = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::optional<DiscreteHit>> hits(rays.size(), DiscreteHit{});
  scene.intersect(rays, times, hits);
  size_t hit_count = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto one = scene.intersect(rays[i], times[i]);
    ASSERT_EQ(one.has_value(), hits[i].has_value()) << i;
    if (!one) continue;
    ++hit_count;
    EXPECT_EQ(one->mesh, hits[i]->mesh);
    EXPECT_EQ(one->triangle, hits[i]->triangle);
    EXPECT_NEAR(one->dist, hits[i]->dist, 1e-5f * one->dist);
    EXPECT_EQ(one->front, hits[i]->front);
  }
  EXPECT_GT(hit_count, 300u);
  // However many go together, and whatever is in the lanes that are left over.
  for (const size_t count : {1, 7, 8, 9, 15, 16, 17, 24, 25}) {
    std::vector<std::optional<DiscreteHit>> some(count, DiscreteHit{});
    scene.intersect(std::span(rays).subspan(20, count), std::span(times).subspan(20, count), some);
    for (size_t i = 0; i < count; ++i) {
      ASSERT_EQ(some[i].has_value(), hits[20 + i].has_value()) << i << " of " << count;
      if (some[i]) {
        EXPECT_EQ(some[i]->triangle, hits[20 + i]->triangle);
      }
    }
  }
  for (size_t i : {5, 6, 7, 8}) EXPECT_FALSE(hits[i]);
  EXPECT_THROW(scene.intersect(rays, std::span(times).first(3), hits), Error);
}

/// What stands still, even keys, uneven ones, one-sided meshes and panes; rays of any length.
TEST(Discrete, AnyHitSaysWhatTheNearestOneDoes) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  for (const test::Motion motion : {test::Motion::still, test::Motion::deform, test::Motion::translation})
    for (const bool one_sided : {false, true}) {
      meshes.push_back(test::random_soup(random, motion, 6));
      meshes.back().one_sided = one_sided;
    }
  for (int i = 0; i < 8; ++i)  // more sets of key times than have scenes of their own
    meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::deform, 4), 4));
  meshes.back().one_sided = true;
  DiscreteOptions options;
  options.panes.resize(meshes.size());
  std::vector<Mesh> opaque = meshes, glass(meshes.size());
  for (const size_t pane : {size_t{1}, size_t{2}, size_t{7}}) {
    options.panes[pane] = true;
    opaque[pane].triangles.clear();
    glass[pane] = meshes[pane];
  }
  const DiscreteScene scene(meshes, options), without_panes(opaque), only_panes(glass);
  EXPECT_TRUE(scene.has_panes());
  EXPECT_FALSE(without_panes.has_panes());
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Ray> rays;
  std::vector<float> times, dists;
  for (int i = 0; i < 600; ++i) {
    rays.push_back({{uniform(random), uniform(random), 0}, {0.4f * uniform(random), 0.4f * uniform(random), -1}});
    times.push_back(std::abs(uniform(random)));
    dists.push_back(i % 3 == 0 ? std::numeric_limits<float>::infinity() : 4 + 8 * std::abs(uniform(random)));
  }
  dists[3] = 0;
  const auto result = std::make_unique<bool[]>(rays.size());
  scene.occluded(rays, times, dists, {result.get(), rays.size()});
  size_t occluded = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const bool nearest = without_panes.intersect(rays[i], times[i], dists[i], Facing::far_end).has_value();
    ASSERT_EQ(scene.occluded(rays[i], times[i], dists[i]), nearest) << i;
    ASSERT_EQ(result[i], nearest) << i;
    occluded += nearest;
    const auto pane = scene.intersect_panes(rays[i], times[i], dists[i]);
    const auto expected = only_panes.intersect(rays[i], times[i], dists[i], Facing::far_end);
    ASSERT_EQ(pane.has_value(), expected.has_value());
    if (pane) {
      EXPECT_EQ(pane->mesh, expected->mesh);
    }
  }
  EXPECT_GT(occluded, 60u);
  EXPECT_LT(occluded, 540u);
  EXPECT_THROW(scene.occluded(rays, times, std::span(dists).first(2), {result.get(), rays.size()}), Error);
}

TEST(Discrete, EmptyAndBroken) {
  EXPECT_FALSE(DiscreteScene({}).intersect(ray_at(0), 0));
  std::vector<Mesh> meshes{make_slider({0, 1}, {0, 1}, -5)};
  meshes[0].triangles = {{0, 1, 3}};
  EXPECT_THROW(DiscreteScene{meshes}, Error);
}

#if defined(__SSE__)
TEST(Discrete, LeavesTheThreadsArithmeticAlone) {
  const std::vector<Mesh> meshes{make_slider({0, 1}, {0, 1}, -5)};
  const unsigned before = _mm_getcsr();
  const DiscreteScene scene(meshes);
  EXPECT_EQ(_mm_getcsr() & 0x8040u, before & 0x8040u);
  scene.intersect(ray_at(0), 0.1f);
  EXPECT_EQ(_mm_getcsr() & 0x8040u, before & 0x8040u);
  volatile float smallest = std::numeric_limits<float>::min();
  EXPECT_GT(smallest / 2, 0);
}
#endif

}  // namespace
}  // namespace kairos
