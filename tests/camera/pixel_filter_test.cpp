#include "camera/pixel_filter.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kairos {
namespace {

double variance(const PixelFilter& filter) {
  constexpr int kSteps = 100000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double offset = filter.offset((static_cast<float>(i) + 0.5f) / kSteps);
    sum += offset * offset;
  }
  return sum / kSteps;
}

TEST(PixelFilter, BoxIsThePixel) {
  const PixelFilter box(FilterKind::box);
  EXPECT_EQ(box.offset(0), -0.5);
  EXPECT_EQ(box.offset(0.5f), 0);
  EXPECT_NEAR(variance(box), 1.0 / 12, 1e-6);
}

TEST(PixelFilter, OffsetsAscendAndAreAntisymmetric) {
  for (const auto kind : {FilterKind::box, FilterKind::gaussian, FilterKind::blackman_harris}) {
    const PixelFilter filter(kind);
    double before = -filter.radius();
    for (int i = 0; i < 4096; ++i) {
      const double offset = filter.offset(static_cast<float>(i) / 4096);
      EXPECT_GE(offset, before);
      EXPECT_NEAR(offset, -filter.offset(1 - static_cast<float>(i) / 4096), 1e-6);
      before = offset;
    }
    EXPECT_LE(before, filter.radius());
    EXPECT_GT(before, filter.radius() * 0.8 - (kind == FilterKind::box ? 0 : 0.7));
  }
}

TEST(PixelFilter, GaussianFollowsItsDistribution) {
  const PixelFilter gaussian(FilterKind::gaussian);
  const double inside = std::erf(3 / std::sqrt(2.0));  // cut at three standard deviations
  for (const double offset : {0.1, 0.5, 0.8, 1.2}) {
    const double u = 0.5 + 0.5 * std::erf(offset / 0.5 / std::sqrt(2.0)) / inside;
    EXPECT_NEAR(gaussian.offset(static_cast<float>(u)), offset, 2e-3);
  }
}

TEST(PixelFilter, BlackmanHarrisHasItsVariance) {
  // Of a0 + a1 cos(pi x / R) + a2 cos(2 pi x / R) + a3 cos(3 pi x / R) over [-R, R], R = 1.5: integrals in closed form.
  const double a[4] = {0.35875, 0.48829, 0.14128, 0.01168}, radius = 1.5;
  double moment = a[0] * 2 * std::pow(radius, 3) / 3;
  for (int k = 1; k < 4; ++k) moment += a[k] * (k % 2 ? -1 : 1) * 4 * std::pow(radius, 3) / std::pow(M_PI * k, 2);
  EXPECT_NEAR(variance(PixelFilter(FilterKind::blackman_harris)), moment / (2 * radius * a[0]), 1e-3);
}

}  // namespace
}  // namespace kairos
