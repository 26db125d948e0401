#include "shading/spread.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "math/hash.h"

namespace kairos {
namespace {

Segment segment(float begin, float end) {
  Segment s;
  s.begin = begin;
  s.end = end;
  return s;
}

bool always(const Segment&) { return true; }
bool apart(const Segment&, const Segment&) { return false; }
bool joined(const Segment&, const Segment&) { return true; }

const std::vector<Segment> kSegments = {segment(0, 0.05f), segment(0.05f, 0.4f), segment(0.5f, 0.5000001f),
                                        segment(0.6f, 0.9f)};

TEST(Spread, PartsCoverEverySegmentExactly) {
  std::vector<ShadingSample> samples;
  for (uint64_t trial = 0; trial < 1000; ++trial)
    for (const int count : {1, 3, 8, 100}) {
      spread_samples(kSegments, count, unit_float(hash(trial, 0)), unit_float(hash(trial, 1)), apart, always, samples);
      size_t next = 0;
      for (uint32_t i = 0; i < kSegments.size(); ++i) {
        float at = kSegments[i].begin;
        ASSERT_TRUE(next < samples.size() && samples[next].segment == i) << "each has at least one";
        for (; next < samples.size() && samples[next].segment == i; ++next) {
          EXPECT_EQ(samples[next].begin, at);
          at = samples[next].end;
          EXPECT_GE(samples[next].time, samples[next].begin);
          EXPECT_LT(samples[next].time, kSegments[i].end);
        }
        EXPECT_EQ(at, kSegments[i].end);
      }
      EXPECT_EQ(next, samples.size());
      EXPECT_LE(samples.size(), static_cast<size_t>(count) + kSegments.size());
    }
}

TEST(Spread, LongSegmentsGetMoreSamples) {
  std::vector<ShadingSample> samples;
  std::map<uint32_t, int> counts;
  const int trials = 2000, per_ray = 40;
  for (uint64_t trial = 0; trial < trials; ++trial) {
    spread_samples(kSegments, per_ray, unit_float(hash(trial, 0)), 0.5f, apart, always, samples);
    for (const ShadingSample& s : samples) ++counts[s.segment];
  }
  const double visible = 0.05 + 0.35 + 0.3;
  EXPECT_NEAR(counts[1] / double{trials}, per_ray * 0.35 / visible, 0.1);
  EXPECT_NEAR(counts[3] / double{trials}, per_ray * 0.3 / visible, 0.1);
  EXPECT_NEAR(counts[2] / double{trials}, 1, 1e-9);
}

// Segments 0 and 1 touch and are one cluster; the others are one each.
TEST(Spread, ClustersAreCutAsIfTheyWereOneSegment) {
  std::vector<ShadingSample> samples;
  for (uint64_t trial = 0; trial < 1000; ++trial)
    for (const int count : {1, 3, 8, 100}) {
      const double share = unit_float(hash(trial, 0));
      const float phase = unit_float(hash(trial, 1));
      spread_samples(kSegments, count, share, phase, joined, always, samples);
      const std::vector<Segment> merged = {segment(0, 0.4f), kSegments[2], kSegments[3]};
      std::vector<ShadingSample> expected;
      spread_samples(merged, count, share, phase, apart, always, expected);
      ASSERT_EQ(samples.size(), expected.size());
      for (size_t i = 0; i < samples.size(); ++i) {
        const ShadingSample &s = samples[i], &e = expected[i];
        EXPECT_EQ(s.begin, e.begin);
        EXPECT_EQ(s.end, e.end);
        EXPECT_EQ(s.time, e.time);
        EXPECT_LE(kSegments[s.first].begin, s.begin);
        EXPECT_LT(s.begin, kSegments[s.first].end);
        EXPECT_LE(kSegments[s.segment].begin, s.time);
        EXPECT_LT(s.time, kSegments[s.segment].end);
      }
    }
  spread_samples(kSegments, 1, 0, 0.5f, joined, always, samples);
  EXPECT_EQ(samples.size(), 3u) << "one for each cluster";
}

TEST(Spread, WhatDoesNotTouchIsNoCluster) {
  const std::vector<Segment> gap = {segment(0.1f, 0.2f), segment(0.2000001f, 0.3f)};
  std::vector<ShadingSample> samples;
  spread_samples(gap, 1, 0, 0.5f, joined, always, samples);
  EXPECT_EQ(samples.size(), 2u);
}

// Far more samples than there are numbers in the segment: none is empty, and they still cover it.
TEST(Spread, TooShortForAllOfThem) {
  const float begin = 0.75f, end = std::nextafter(std::nextafter(begin, 1.0f), 1.0f);
  const std::vector<Segment> two = {segment(begin, std::nextafter(begin, 1.0f)),
                                    segment(std::nextafter(begin, 1.0f), end)};
  std::vector<ShadingSample> samples;
  for (const float phase : {0.0f, 0.4f, 0.999999f}) {
    spread_samples(two, 1000, 0.5, phase, joined, always, samples);
    float at = begin;
    for (const ShadingSample& s : samples) {
      EXPECT_EQ(s.begin, at);
      EXPECT_LT(s.begin, s.end);
      EXPECT_LT(s.time, s.end);
      at = s.end;
    }
    EXPECT_EQ(at, end);
  }
}

// The mean over rays of sum(duration x f(time)) is the integral of f over the visible time, with clusters too.
TEST(Spread, IsUnbiased) {
  const auto f = [](double time) { return time * time + (time > 0.2 ? 1 : 0); };
  double exact = 0;
  for (const Segment& s : kSegments) {
    exact += (std::pow(s.end, 3.0) - std::pow(s.begin, 3.0)) / 3;
    exact += std::max(0.0, s.end - std::max(0.2, static_cast<double>(s.begin)));
  }
  std::vector<ShadingSample> samples;
  using Join = bool (*)(const Segment&, const Segment&);
  for (const auto& [count, join] :
       std::vector<std::pair<int, Join>>{{1, apart}, {1, joined}, {2, joined}, {5, apart}}) {
    const int trials = 200000;
    double sum = 0, squares = 0;
    for (uint64_t trial = 0; trial < trials; ++trial) {
      spread_samples(kSegments, count, unit_float(hash(trial, 0)), unit_float(hash(trial, 1)), join, always, samples);
      double estimate = 0;
      for (const ShadingSample& s : samples) estimate += (s.end - s.begin) * f(s.time);
      sum += estimate;
      squares += estimate * estimate;
    }
    const double mean = sum / trials, deviation = std::sqrt((squares / trials - mean * mean) / trials);
    EXPECT_NEAR(mean, exact, 4.5 * deviation) << count;
    EXPECT_LT(deviation, 2e-3);
  }
}

TEST(Spread, OneSampleWhereNothingChanges) {
  std::vector<ShadingSample> samples;
  spread_samples(
      kSegments, 100, 0.5, 0.5f, apart, [](const Segment& s) { return s.end > 0.8f; }, samples);
  std::map<uint32_t, int> counts;
  for (const ShadingSample& s : samples) ++counts[s.segment];
  EXPECT_EQ(counts[0], 1);
  EXPECT_EQ(counts[1], 1);
  EXPECT_GT(counts[3], 40);
}

TEST(Spread, NothingSeenNeedsNoSample) {
  std::vector<ShadingSample> samples{{}};
  spread_samples({}, 8, 0.5, 0.5f, apart, always, samples);
  EXPECT_TRUE(samples.empty());
}

}  // namespace
}  // namespace kairos
