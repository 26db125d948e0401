#include "math/sampler.h"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "math/hash.h"

namespace kairos {
namespace {

std::vector<SamplePoint> points_of(SamplerKind kind, uint32_t count, int x, int y, uint64_t seed) {
  const Sampler sampler(kind, count, seed);
  const Sampler::Pixel pixel = sampler.pixel(x, y);
  std::vector<SamplePoint> points;
  for (uint32_t i = 0; i < count; ++i) points.push_back(sampler.point(pixel, i));
  return points;
}

// How many of 2^m cells, 2^a by 2^(m - a) of them, hold one point.
size_t cells_hit(const std::vector<SamplePoint>& points, int m, int a) {
  std::set<std::pair<int, int>> hit;
  for (const SamplePoint& p : points)
    hit.emplace(static_cast<int>(std::ldexp(p.x, a)), static_cast<int>(std::ldexp(p.y, m - a)));
  return hit.size();
}

TEST(OwenSobol, EveryElementaryIntervalOfXAndYHoldsOnePoint) {
  for (int m = 0; m <= 10; ++m)
    for (int seed = 0; seed < 5; ++seed) {
      const auto points = points_of(SamplerKind::owen_sobol, 1u << m, 3 + seed, 7, static_cast<uint64_t>(seed));
      for (int a = 0; a <= m; ++a) EXPECT_EQ(cells_hit(points, m, a), points.size()) << "2^" << m << ", 2^" << a;
    }
}

// With time the quality parameter is 1, the sum of (degree - 1) over the polynomials: 2^m points put two into every
// elementary box of volume 2^(1 - m).
TEST(OwenSobol, EveryElementaryBoxOfXYAndTimeHoldsTwoPoints) {
  for (int m = 1; m <= 9; ++m) {
    const auto points = points_of(SamplerKind::owen_sobol, 1u << m, 3, m, 5);
    for (int a = 0; a < m; ++a)
      for (int b = 0; a + b < m; ++b) {
        std::map<std::array<int, 3>, int> boxes;
        for (const SamplePoint& p : points)
          ++boxes[{static_cast<int>(std::ldexp(p.x, a)), static_cast<int>(std::ldexp(p.y, b)),
                   static_cast<int>(std::ldexp(p.time, m - 1 - a - b))}];
        for (const auto& [box, count] : boxes) ASSERT_EQ(count, 2) << "2^" << m << ", 2^" << a << ", 2^" << b;
      }
  }
}

TEST(OwenSobol, EveryPrefixOfAPowerOfTwoIsANet) {
  auto points = points_of(SamplerKind::owen_sobol, 1000, 1, 2, 3);
  points.resize(256);
  for (int a = 0; a <= 8; ++a) EXPECT_EQ(cells_hit(points, 8, a), 256u);
}

TEST(AllSamplers, TimeIsStratifiedWhereItShouldBe) {
  for (const auto kind : {SamplerKind::owen_sobol, SamplerKind::multi_jitter})
    for (const uint32_t count : {1u, 16u, 64u, 1024u}) {
      std::set<int> strata;
      for (const SamplePoint& p : points_of(kind, count, 5, 6, 1))
        strata.insert(static_cast<int>(p.time * static_cast<float>(count)));
      EXPECT_EQ(strata.size(), count);
    }
}

TEST(MultiJitter, XAndYAreStratifiedAlsoInTwoDimensions) {
  for (const uint32_t side : {1u, 4u, 7u, 32u}) {
    const auto points = points_of(SamplerKind::multi_jitter, side * side, 2, 9, 4);
    std::set<int> fine_x, fine_y, cells;
    const auto n = static_cast<float>(side);
    for (const SamplePoint& p : points) {
      fine_x.insert(static_cast<int>(p.x * n * n));
      fine_y.insert(static_cast<int>(p.y * n * n));
      cells.insert(static_cast<int>(p.x * n) * 1000 + static_cast<int>(p.y * n));
    }
    EXPECT_EQ(cells.size(), side * side);
    EXPECT_EQ(fine_x.size(), side * side);
    EXPECT_EQ(fine_y.size(), side * side);
  }
}

TEST(AllSamplers, PointsAreInsideAndUnbiased) {
  for (const auto kind : {SamplerKind::owen_sobol, SamplerKind::multi_jitter, SamplerKind::random})
    for (const uint32_t count : {1u, 3u, 7u, 16u, 50u}) {
      double sum[6]{};
      const int pixels = 4000;
      for (int i = 0; i < pixels; ++i)
        for (const SamplePoint& p : points_of(kind, count, i, i / 7, 11)) {
          const float v[3] = {p.x, p.y, p.time};
          for (int k = 0; k < 3; ++k) {
            ASSERT_GE(v[k], 0);
            ASSERT_LT(v[k], 1);
            sum[k] += v[k];
          }
          sum[3] += p.x * p.y;
          sum[4] += p.y * p.time;
          sum[5] += p.x * p.time;
        }
      const double n = pixels * static_cast<double>(count);
      // Five standard deviations of independent points, the worst of the three samplers.
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k] / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
      for (int k = 3; k < 6; ++k) EXPECT_NEAR(sum[k] / n, 0.25, 5 * std::sqrt(7.0 / 144 / n));
    }
}

// The flips that scrambling makes at the nodes of its first four levels, 1 + 2 + 4 + 8 of them, must be independent:
// over many seeds each of the 2^15 outcomes comes up equally often.
TEST(OwenSobol, FlipsOfTheFirstLevelsAreIndependent) {
  constexpr int kLevels = 4, kOutcomes = 1 << ((1 << kLevels) - 1), kPerOutcome = 16;
  std::vector<int> counts(kOutcomes);
  for (uint64_t seed = 0; seed < uint64_t{kOutcomes} * kPerOutcome; ++seed) {
    const OwenKey key = make_owen_key(seed);
    int outcome = 0, node = 0;
    for (int level = 0; level < kLevels; ++level)
      for (uint32_t prefix = 0; prefix < (1u << level); ++prefix)
        outcome |= static_cast<int>(owen_scramble(prefix, key) >> (31 - level) & 1u) << node++;
    ++counts[static_cast<size_t>(outcome)];
  }
  double chi_square = 0;
  for (const int count : counts) chi_square += (count - kPerOutcome) * (count - kPerOutcome) / double{kPerOutcome};
  const double z = (chi_square - (kOutcomes - 1)) / std::sqrt(2.0 * (kOutcomes - 1));
  EXPECT_LT(std::abs(z), 4);
}

// Deeper down: changing a digit flips every later one in half of the cases.
TEST(OwenSobol, EveryLaterDigitDependsOnEveryEarlierOne) {
  constexpr int kTrials = 4000;
  for (int digit = 0; digit < 24; ++digit)
    for (int later = digit + 1; later < 24; ++later) {
      int flips = 0;
      for (uint64_t trial = 0; trial < kTrials; ++trial) {
        const OwenKey key = make_owen_key(hash(trial, digit, later));
        const auto value = static_cast<uint32_t>(hash(trial, 99));
        const uint32_t changed = owen_scramble(value, key) ^ owen_scramble(value ^ (1u << digit), key);
        flips += static_cast<int>(changed >> (31 - later) & 1u);
      }
      EXPECT_NEAR(flips, kTrials / 2, 5 * std::sqrt(kTrials) / 2) << digit << " " << later;
    }
}

TEST(Sampler, PixelsAndSeedsDifferAndRepeat) {
  const auto first = [](int x, int y, uint64_t seed) { return points_of(SamplerKind::owen_sobol, 4, x, y, seed)[0].x; };
  EXPECT_EQ(first(1, 2, 3), first(1, 2, 3));
  EXPECT_NE(first(1, 2, 3), first(2, 1, 3));
  EXPECT_NE(first(1, 2, 3), first(1, 2, 4));
}

TEST(Sampler, RefusesCountsOutOfRange) {
  EXPECT_THROW(Sampler(SamplerKind::random, 0, 0), Error);
  EXPECT_THROW(Sampler(SamplerKind::random, Sampler::kMaxCount + 1, 0), Error);
}

}  // namespace
}  // namespace kairos
