// Discrete rays against moving triangles whose answers are known.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "discrete/discrete_scene.h"
#include "sliders.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kairos {
namespace {

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

TEST(Discrete, LooksNoFartherThanAsked) {
  const std::vector<Mesh> meshes{make_slider({}, {0}, -5)};
  const DiscreteScene scene(meshes);
  EXPECT_TRUE(scene.intersect(ray_at(0), 0.5f, 5.01f));
  EXPECT_FALSE(scene.intersect(ray_at(0), 0.5f, 4.99f));
  EXPECT_FALSE(scene.intersect(ray_at(0), 0.5f, NAN));
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
