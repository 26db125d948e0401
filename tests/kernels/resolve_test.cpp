// From hits to segments: the lower envelope, on cases with known answers and on random ones by brute force.
#include "kernels/resolve.h"

#include <random>

#include <gtest/gtest.h>

#include "kernels/time_bins.h"
#include "soup.h"

namespace kairos {
namespace {

std::vector<Segment> visible(std::vector<Segment> hits) {
  ResolveScratch scratch;
  std::vector<Segment> out;
  resolve_visible(hits, scratch, out);
  return out;
}

Segment hit(float begin, float end, float dist_begin, float dist_end, uint32_t triangle) {
  return {begin, end, dist_begin, dist_end, 0, triangle, true};
}

TEST(Resolve, TheNearerOneIsSeenAndTheFartherOneBeforeAndAfter) {
  const auto seen = visible({hit(0.25f, 0.75f, 1, 1, 1), hit(0, 1, 2, 4, 0)});
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].triangle, 0u);
  EXPECT_EQ(seen[0].end, 0.25f);
  EXPECT_EQ(seen[0].dist_end, 2.5f);
  EXPECT_EQ(seen[1].triangle, 1u);
  EXPECT_EQ(seen[1].end, 0.75f);
  EXPECT_EQ(seen[2].triangle, 0u);
  EXPECT_EQ(seen[2].dist_begin, 3.5f);
  EXPECT_EQ(seen[2].end, 1.0f);
}

TEST(Resolve, TwoThatPassThroughEachOtherChangePlacesWhereTheyMeet) {
  const auto seen = visible({hit(0, 1, 1, 3, 0), hit(0, 1, 2, 1, 1)});
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].triangle, 0u);
  EXPECT_NEAR(seen[0].end, 1.0 / 3, 1e-6);
  EXPECT_EQ(seen[1].begin, seen[0].end);
  EXPECT_EQ(seen[1].triangle, 1u);
}

TEST(Resolve, NeighboursThatMissEachOtherByRoundingLeaveNoSliverOfWhatIsBehind) {
  const float end = 0.5f, begin = 0.5f + 0.5f * kTimeSnap;
  for (const auto& [first_end, second_begin] : {std::pair(end, begin), std::pair(begin, end)}) {
    for (const bool something_behind : {true, false}) {
      std::vector<Segment> hits{hit(0, first_end, 1, 1, 0), hit(second_begin, 1, 1, 1, 1)};
      if (something_behind) hits.push_back(hit(0, 1, 5, 5, 2));
      const auto seen = visible(hits);
      ASSERT_EQ(seen.size(), 2u);
      EXPECT_EQ(seen[0].triangle, 0u);
      EXPECT_EQ(seen[1].triangle, 1u);
      EXPECT_EQ(seen[0].end, seen[1].begin);
      EXPECT_EQ(seen[0].begin, 0);
      EXPECT_EQ(seen[1].end, 1);
    }
  }
}

TEST(Resolve, RunsOfSliversLeaveNoGap) {
  // Eight hits of less than a sliver each, one after the other: before a longer one, after it, and on their own.
  constexpr float kStep = 0.4f * kTimeSnap;
  for (const float start : {0.0f, 0.25f}) {
    std::vector<Segment> hits;
    float time = start;
    for (uint32_t i = 0; i < 8; ++i, time += kStep) hits.push_back(hit(time, time + kStep, 1, 1, i));
    const auto alone = visible(hits);
    ASSERT_FALSE(alone.empty());
    EXPECT_EQ(alone.front().begin, start);
    EXPECT_NEAR(alone.back().end, time, 0.5f * kTimeSnap);
    hits.push_back(hit(time, 0.5f, 1, 1, 8));
    for (uint32_t i = 0; i < 8; ++i)
      hits.push_back(hit(0.5f + static_cast<float>(i) * kStep, 0.5f + static_cast<float>(i + 1) * kStep, 1, 1, 9 + i));
    const auto seen = visible(hits);
    EXPECT_EQ(seen.front().begin, start);
    for (size_t i = 1; i < seen.size(); ++i) EXPECT_EQ(seen[i].begin, seen[i - 1].end);
    EXPECT_EQ(seen.back().end, hits.back().end);
  }
}

TEST(Resolve, StretchesOfOneTriangleThatFollowOnEachOtherAreOneSegment) {
  const auto seen = visible({hit(0.5f, 1, 2, 3, 4), hit(0, 0.5f, 1, 2, 4)});
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].dist_begin, 1);
  EXPECT_EQ(seen[0].dist_end, 3);
}

TEST(Resolve, OfTwoAtTheSameDistanceTheOneThatComesNearerIsSeenThenTheLowerIndex) {
  EXPECT_EQ(visible({hit(0, 1, 1, 1, 3), hit(0, 1, 1, 1, 2)}).at(0).triangle, 2u);
  EXPECT_EQ(visible({hit(0, 1, 2, 3, 0), hit(0, 1, 2, 1, 1)}).at(0).triangle, 1u);
}

TEST(Resolve, IsTheLowerEnvelopeOfRandomPieces) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  size_t instants = 0, wrong = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<Segment> hits;
    const int count = static_cast<int>(uniform(0, 40));
    for (int i = 0; i < count; ++i) {
      const float begin = uniform(0, 0.99f),
                  end = std::min(1.0f, begin + uniform(0.001f, trial % 2 == 0 ? 1.0f : 0.1f));
      hits.push_back(hit(begin, end, uniform(1, 2), uniform(1, 2), static_cast<uint32_t>(i)));
    }
    const auto seen = visible(hits);
    for (size_t i = 0; i < seen.size(); ++i) {
      ASSERT_LT(seen[i].begin, seen[i].end);
      ASSERT_GE(seen[i].begin, i == 0 ? 0 : seen[i - 1].end);
    }
    for (int k = 0; k < 50; ++k) {
      const float time = uniform(0, 1);
      int64_t nearest = -1;
      double nearest_dist = INFINITY;
      for (const Segment& s : hits) {
        if (!(s.begin <= time && time < s.end)) continue;
        const double dist =
            s.dist_begin + (double(time) - s.begin) / (double(s.end) - s.begin) * (s.dist_end - s.dist_begin);
        if (dist < nearest_dist) {
          nearest_dist = dist;
          nearest = s.triangle;
        }
      }
      ++instants;
      wrong += nearest != test::triangle_at(seen, time);
    }
  }
  EXPECT_LE(wrong, instants / 5000);  // instants within rounding of a change
}

TEST(TimeBins, AHitThatSpansABinHidesWhatIsBehindThereAndNowhereElse) {
  TimeBins bins;
  bins.clear();
  bins.cover(0, 0.5f, 3);
  EXPECT_EQ(bins.visible_until(TimeBins::touched(0, 0.5f)), 3);
  EXPECT_EQ(bins.visible_until(TimeBins::touched(0, 0.51f)), INFINITY);
  float begin = 0.25f, end = 1;
  EXPECT_TRUE(TimeBins::clip(bins.reaching(3.5f), begin, end));
  EXPECT_EQ(begin, 0.5f);
  EXPECT_EQ(end, 1);
  begin = 0.1f, end = 0.4f;
  EXPECT_FALSE(TimeBins::clip(bins.reaching(3.5f), begin, end));
  EXPECT_TRUE(TimeBins::clip(bins.reaching(2.5f), begin, end));
}

TEST(TimeBins, RunsOfShortHitsCloseABin) {
  TimeBins bins;
  bins.clear();
  constexpr float kBin = 1.0f / TimeBins::kCount;
  // From both ends towards the middle: two open runs that meet.
  for (const float place : {0.0f, 0.75f, 0.25f, 0.5f}) {
    EXPECT_EQ(bins.visible_until(TimeBins::touched(0, kBin)), INFINITY);
    bins.cover(place * kBin, (place + 0.25f) * kBin, 1 + place);
  }
  EXPECT_EQ(bins.visible_until(TimeBins::touched(0, kBin)), 1.75f);
}

TEST(TimeBins, NeverHideWhatCanBeSeen) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  for (int trial = 0; trial < 500; ++trial) {
    TimeBins bins;
    bins.clear();
    std::vector<Segment> hits;
    for (int i = 0; i < 60; ++i) {
      const float begin = uniform(0, 0.95f), end = std::min(1.0f, begin + uniform(0.001f, 0.1f));
      const Segment h = hit(begin, end, uniform(1, 2), uniform(1, 2), static_cast<uint32_t>(i));
      hits.push_back(h);
      bins.cover(h.begin, h.end, std::max(h.dist_begin, h.dist_end));
    }
    for (int k = 0; k < 100; ++k) {
      const float time = uniform(0, 0.999f);
      double nearest = INFINITY;
      for (const Segment& s : hits)
        if (s.begin <= time && time < s.end)
          nearest = std::min<double>(nearest,
                                     s.dist_begin + (time - s.begin) / (s.end - s.begin) * (s.dist_end - s.dist_begin));
      // The bin's bound is a farthest distance: nothing nearer than all hits at this instant may be cut off.
      EXPECT_GE(bins.visible_until(TimeBins::touched(time, std::nextafter(time, 2.0f))) * (1 + 1e-6), nearest);
    }
  }
}

}  // namespace
}  // namespace kairos
