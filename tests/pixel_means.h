// Two ways of rendering a picture whose pixels have the same mean, whatever their noise: tested over many seeds.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/render.h>

namespace kairos::test {

/// 256 with KAIROS_LONG, by which a bias of a thirtieth of a pixel's noise is found; else `few`.
inline int seeds_of_means(int few) { return std::getenv("KAIROS_LONG") != nullptr ? 256 : few; }

/// Of red: sums over seeds of values and of their squares.
using PixelSums = std::vector<std::array<double, 2>>;

/// Seeds are drawn from `random`. No value may be negative or no number.
inline PixelSums sums_over_seeds(Renderer& renderer, RenderParams params, int seeds, std::mt19937& random) {
  PixelSums sums;
  for (int i = 0; i < seeds; ++i) {
    params.seed = random();
    const Image image = renderer.render(params);
    const std::vector<float>& values = image.find("R")->values;
    sums.resize(values.size());
    for (size_t p = 0; p < sums.size(); ++p) {
      const auto value = static_cast<double>(values[p]);
      EXPECT_TRUE(std::isfinite(value) && value >= 0);
      sums[p][0] += value;
      sums[p][1] += value * value;
    }
  }
  return sums;
}

inline void expect_same_means(const PixelSums& a, const PixelSums& b, int seeds, const std::string& what) {
  double squares = 0, difference = 0, variance = 0;
  int seen = 0;
  for (size_t p = 0; p < a.size(); ++p) {
    const auto variance_of = [&](const std::array<double, 2>& sum) {
      return (sum[1] - sum[0] * sum[0] / seeds) / (seeds - 1) / seeds;
    };
    const double apart = (a[p][0] - b[p][0]) / seeds, both = variance_of(a[p]) + variance_of(b[p]);
    const double mean = a[p][0] / seeds;
    difference += apart;
    variance += both;
    if (both < 1e-7 * mean * mean + 1e-12) continue;  // the same in all seeds: rounding
    squares += apart * apart / both;
    ++seen;
  }
  ASSERT_GT(seen, static_cast<int>(a.size()) / 2) << what;
  // Of few seeds, variances are estimates themselves.
  EXPECT_LT(squares / seen, 1.6 + 32.0 / seeds) << what << ": 1 for what differs by noise alone";
  EXPECT_LT(std::abs(difference), 5 * std::sqrt(variance)) << what;
}

}  // namespace kairos::test
