// What of blended surfaces is seen in front of what, and when; and the roulette that ends the search behind them.
#include "shading/layers.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/record.h>

#include "kernels/blended.h"
#include "seed.h"
#include "shading/roulette.h"

namespace kairos {
namespace {

TEST(Roulette, KeepsTheMean) {
  for (const float open : {kLeastOpen, 1.5f * kLeastOpen, 3 * kLeastOpen})
    for (const float opacity : {0.0f, 0.1f, 0.5f, 0.9f, 0.99f, 1.0f}) {
      double after = 0;
      constexpr int kChances = 1 << 12;
      for (int i = 0; i < kChances; ++i) {
        const float used = roulette(open, opacity, (static_cast<float>(i) + 0.5f) / kChances);
        const float left = open * (1 - used);
        EXPECT_TRUE(left == 0 || left > 0.999f * kLeastOpen) << open << " " << opacity;
        after += static_cast<double>(left);
      }
      EXPECT_NEAR(after / kChances, open * (1 - opacity), 1e-3 * kLeastOpen);
    }
  EXPECT_EQ(roulette(1, 0.5f, 0.3f), 0.5f);
}

Segment random_segment(std::mt19937& random, uint32_t mesh) {
  std::uniform_real_distribution<float> unit(0, 1);
  float begin = unit(random), end = unit(random);
  if (begin > end) std::swap(begin, end);
  return {begin, std::max(end, begin + 1e-3f), 1 + unit(random), 1 + unit(random), mesh, mesh, true};
}

TEST(Layers, AreCutToWhatNothingHides) {
  std::mt19937 random(test::seed());
  for (int round = 0; round < 200; ++round) {
    std::vector<Segment> blended, opaque, out;
    for (uint32_t i = 0; i < 6; ++i) blended.push_back(random_segment(random, i));
    for (uint32_t i = 6; i < 10; ++i) opaque.push_back(random_segment(random, i));
    BlendedScratch scratch;
    clip_blended(blended, opaque, scratch, out);
    for (int i = 0; i < 101; ++i) {
      const float time = (static_cast<float>(i) + 0.37f) / 101;
      float nearest = INFINITY, margin = INFINITY;
      const auto is_at = [&](const Segment& s) { return s.begin <= time && time < s.end; };
      for (const Segment& hit : opaque)
        if (is_at(hit)) nearest = std::min(nearest, distance_at(hit, time));
      std::vector<uint32_t> expected, found;
      for (const Segment& v : blended) {
        if (!is_at(v)) continue;
        margin = std::min(margin, std::abs(distance_at(v, time) - nearest));
        if (distance_at(v, time) < nearest) expected.push_back(v.mesh);
      }
      if (margin < 1e-5f) continue;
      for (const Segment& v : out)
        if (is_at(v)) found.push_back(v.mesh);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << "round " << round << ", time " << time;
    }
  }
}

TEST(Layers, AreInOrderAtEveryInstant) {
  std::mt19937 random(test::seed());
  Layers layers;
  for (int round = 0; round < 200; ++round) {
    std::vector<Segment> blended;
    for (uint32_t i = 0; i < 6; ++i) blended.push_back(random_segment(random, i));
    std::sort(blended.begin(), blended.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    const std::vector<Segment> seen{{0.2f, 0.5f, 5, 5, 10, 0, true}, {0.5f, 0.7f, 5, 5, 11, 0, true}};
    layers.build(seen, blended, round % 2 == 0);
    double sum = 0;
    for (const Segment& s : layers.stretches()) sum += static_cast<double>(s.end) - static_cast<double>(s.begin);
    if (round % 2 == 0) {
      EXPECT_NEAR(sum, 1, 1e-6);
    }
    for (int i = 0; i < 101; ++i) {
      const float time = (static_cast<float>(i) + 0.37f) / 101;
      std::vector<std::pair<float, uint32_t>> expected;
      for (const Segment& v : blended)
        if (v.begin <= time && time < v.end) expected.emplace_back(distance_at(v, time), v.mesh);
      std::sort(expected.begin(), expected.end());
      uint32_t back = kNoMesh;
      for (const Segment& s : seen)
        if (s.begin <= time && time < s.end) back = s.mesh;
      bool is_found = false;
      for (size_t k = 0; k < layers.stretches().size(); ++k) {
        const Segment& stretch = layers.stretches()[k];
        if (!(stretch.begin <= time && time < stretch.end)) continue;
        is_found = true;
        EXPECT_EQ(stretch.mesh, back);
        ASSERT_EQ(layers.before(k).size(), expected.size());
        // By distance: of two that cross just then, rounding may put either in front.
        for (size_t v = 0; v < expected.size(); ++v)
          EXPECT_NEAR(distance_at(blended[layers.before(k)[v]], time), expected[v].first, 1e-4)
              << "round " << round << ", time " << time;
      }
      EXPECT_EQ(is_found, round % 2 == 0 || back != kNoMesh || !expected.empty());
    }
  }
}

}  // namespace
}  // namespace kairos
