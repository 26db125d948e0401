// Discrete rays in packets, and those that any hit answers, against single rays.
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "discrete/discrete_scene.h"
#include "seed.h"
#include "sliders.h"
#include "soup.h"

namespace kairos {
namespace {

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

}  // namespace
}  // namespace kairos
