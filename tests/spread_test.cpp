#include "integrators/spread.h"

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

const std::vector<Segment> kSegments = {segment(0, 0.05f), segment(0.05f, 0.4f), segment(0.5f, 0.5000001f),
                                        segment(0.6f, 0.9f)};

TEST(Spread, PartsCoverEverySegmentExactly) {
  std::vector<ShadingSample> samples;
  for (uint64_t trial = 0; trial < 1000; ++trial)
    for (const int count : {1, 3, 8, 100}) {
      spread_samples(kSegments, count, unit_float(hash(trial, 0)), unit_float(hash(trial, 1)), always, samples);
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
    spread_samples(kSegments, per_ray, unit_float(hash(trial, 0)), 0.5f, always, samples);
    for (const ShadingSample& s : samples) ++counts[s.segment];
  }
  const double visible = 0.05 + 0.35 + 0.3;
  EXPECT_NEAR(counts[1] / double{trials}, per_ray * 0.35 / visible, 0.1);
  EXPECT_NEAR(counts[3] / double{trials}, per_ray * 0.3 / visible, 0.1);
  EXPECT_NEAR(counts[2] / double{trials}, 1, 1e-9);
}

// The mean over rays of sum(duration x f(time)) is the integral of f over the visible time.
TEST(Spread, IsUnbiased) {
  const auto f = [](double time) { return time * time + (time > 0.2 ? 1 : 0); };
  double exact = 0;
  for (const Segment& s : kSegments) {
    exact += (std::pow(s.end, 3.0) - std::pow(s.begin, 3.0)) / 3;
    exact += std::max(0.0, s.end - std::max(0.2, static_cast<double>(s.begin)));
  }
  std::vector<ShadingSample> samples;
  for (const int count : {1, 2, 5}) {
    const int trials = 200000;
    double sum = 0, squares = 0;
    for (uint64_t trial = 0; trial < trials; ++trial) {
      spread_samples(kSegments, count, unit_float(hash(trial, 0)), unit_float(hash(trial, 1)), always, samples);
      double estimate = 0;
      for (const ShadingSample& s : samples) estimate += (s.end - s.begin) * f(s.time);
      sum += estimate;
      squares += estimate * estimate;
    }
    const double mean = sum / trials, deviation = std::sqrt((squares / trials - mean * mean) / trials);
    EXPECT_NEAR(mean, exact, 4.5 * deviation) << count;
    EXPECT_LT(deviation, 1e-3);
  }
}

TEST(Spread, OneSampleWhereNothingChanges) {
  std::vector<ShadingSample> samples;
  spread_samples(
      kSegments, 100, 0.5, 0.5f, [](const Segment& s) { return s.end > 0.8f; }, samples);
  std::map<uint32_t, int> counts;
  for (const ShadingSample& s : samples) ++counts[s.segment];
  EXPECT_EQ(counts[0], 1);
  EXPECT_EQ(counts[1], 1);
  EXPECT_GT(counts[3], 40);
}

TEST(Spread, NothingSeenNeedsNoSample) {
  std::vector<ShadingSample> samples{{}};
  spread_samples({}, 8, 0.5, 0.5f, always, samples);
  EXPECT_TRUE(samples.empty());
}

}  // namespace
}  // namespace kairos
