#include "camera/pixel_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kairos {

namespace {

constexpr double kWideRadius = 1.5;  // pixels
constexpr double kGaussianDeviation = 0.5;
constexpr int kInverseSteps = 512;     // linear interpolation between them stays within 0.01 px
constexpr int kIntegralSteps = 65536;  // over half of the filter

// At distance x, 0 to kWideRadius, from the centre; of any scale.
double profile(FilterKind kind, double x) {
  if (kind == FilterKind::gaussian) return std::exp(-0.5 * x * x / (kGaussianDeviation * kGaussianDeviation));
  const double phase = std::numbers::pi * (x / kWideRadius + 1);  // F. J. Harris (1978), 4 terms, minimum side lobes
  return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind) : radius_(kind == FilterKind::box ? 0.5 : kWideRadius) {
  if (kind == FilterKind::box) return;
  // Cumulative distribution from the centre outwards (midpoint rule); the other half mirrors it.
  std::vector<double> cumulative(kIntegralSteps + 1);
  for (int i = 0; i < kIntegralSteps; ++i)
    cumulative[static_cast<size_t>(i) + 1] =
        cumulative[static_cast<size_t>(i)] + profile(kind, (i + 0.5) / kIntegralSteps * kWideRadius);
  inverse_.resize(kInverseSteps + 1);
  for (int i = 0; i <= kInverseSteps; ++i) {
    const double target = cumulative.back() * i / kInverseSteps;
    const auto above = std::lower_bound(cumulative.begin(), cumulative.end(), target);
    double step = static_cast<double>(above - cumulative.begin());
    if (above != cumulative.begin()) step -= (*above - target) / (*above - *(above - 1));
    inverse_[static_cast<size_t>(i)] = static_cast<float>(step / kIntegralSteps * kWideRadius);
  }
}

double PixelFilter::offset(float u) const {
  const double centred = static_cast<double>(u) - 0.5;
  if (inverse_.empty()) return centred;
  const double position = std::min(std::abs(centred) * 2, 1.0) * kInverseSteps;
  const size_t below = std::min(static_cast<size_t>(position), static_cast<size_t>(kInverseSteps - 1));
  const double weight = position - static_cast<double>(below);
  const double distance = inverse_[below] * (1 - weight) + inverse_[below + 1] * weight;
  return std::copysign(distance, centred);
}

}  // namespace kairos
