// Points along the motion: as even as before, and spread evenly across it.
#include "motion/aligned_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kairos {
namespace {

constexpr int kSide = 256;

/// Points of a fine grid, mapped.
template <class Use>
void for_grid(const AlignedPoints& align, const Use& use) {
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const SamplePoint from{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide, 0.25f};
      use(from, align(from));
    }
}

TEST(AlignedPoints, KeepAreas) {
  for (const double angle : {0.0, 0.3, 0.7853981, 1.2, 1.5707963, 2.5, -0.6}) {
    constexpr int kCells = 8;
    std::vector<int> counts(kCells * kCells);
    for_grid(AlignedPoints(angle), [&](const SamplePoint&, const SamplePoint& to) {
      ASSERT_GE(std::min(to.x, to.y), 0);
      ASSERT_LT(std::max(to.x, to.y), 1);
      EXPECT_EQ(to.time, 0.25f);
      ++counts[static_cast<size_t>(static_cast<int>(to.y * kCells) * kCells + static_cast<int>(to.x * kCells))];
    });
    const double expected = static_cast<double>(kSide) * kSide / (kCells * kCells);
    for (const int count : counts) EXPECT_NEAR(count, expected, 0.06 * expected) << "angle " << angle;
  }
}

TEST(AlignedPoints, SpreadTheFirstCoordinateAcrossTheMotion) {
  for (const double angle : {0.0, 0.3, 0.7853981, 1.2, 2.5, -0.6}) {
    const auto across = [&](const SamplePoint& p) {
      return -std::sin(angle) * static_cast<double>(p.x) + std::cos(angle) * static_cast<double>(p.y);
    };
    // One place across the motion for each x, whatever y; and the order of x is kept.
    std::vector<double> low(kSide, 10), high(kSide, -10);
    for_grid(AlignedPoints(angle), [&](const SamplePoint& from, const SamplePoint& to) {
      const auto column = static_cast<size_t>(from.x * kSide);
      low[column] = std::min(low[column], across(to));
      high[column] = std::max(high[column], across(to));
    });
    for (size_t i = 0; i < kSide; ++i) {
      EXPECT_NEAR(low[i], high[i], 1e-6) << "angle " << angle;
      if (i > 0) {
        EXPECT_LT(high[i - 1], low[i]);
      }
    }
  }
}

TEST(AlignedPoints, WithoutADirectionAreThePointsThemselves) {
  for_grid(AlignedPoints(), [](const SamplePoint& from, const SamplePoint& to) {
    ASSERT_EQ(from.x, to.x);
    ASSERT_EQ(from.y, to.y);
  });
}

}  // namespace
}  // namespace kairos
