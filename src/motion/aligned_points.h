// Sample points of a pixel laid out along the motion in it. docs/method.md, "Points along the motion".
#pragma once

#include <algorithm>
#include <cmath>

#include "math/sampler.h"
#include "motion/motion_mask.h"

namespace kairos {

/// Maps the unit square to itself so that straight lines x = const become lines along the motion, whatever its
/// direction: what is spread evenly over x is then spread evenly across the motion. Areas keep their proportions, so
/// even points stay even. Where there is no direction to follow it changes nothing.
class AlignedPoints {
 public:
  AlignedPoints() = default;
  /// angle: of the motion, radians from the first axis towards the second.
  explicit AlignedPoints(double angle)
      : aligned_(true),
        cos_(std::cos(angle)),
        sin_(std::sin(angle)),
        large_(std::max(std::abs(cos_), std::abs(sin_))),
        small_(std::min(std::abs(cos_), std::abs(sin_))) {}

  SamplePoint operator()(const SamplePoint& point) const {
    if (!aligned_) return point;
    const double across = place_across(static_cast<double>(point.x));
    // Where the line at this distance from the centre, along (cos, sin), enters and leaves the square.
    const double x = -across * sin_, y = across * cos_;
    double first = -kFar, last = kFar;
    const auto cut = [&](double start, double step) {
      if (std::abs(step) < kParallel) return;
      const double a = (-0.5 - start) / step, b = (0.5 - start) / step;
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    };
    cut(x, cos_);
    cut(y, sin_);
    const double along = first + static_cast<double>(point.y) * (last - first);
    const auto inside = [](double v) { return std::clamp(static_cast<float>(v + 0.5), 0.0f, 1 - 0x1p-24f); };
    return {inside(x + along * cos_), inside(y + along * sin_), point.time};
  }

 private:
  static constexpr double kFar = 2;          // more than the square's diagonal
  static constexpr double kParallel = 1e-9;  // a direction that never reaches the square's other side

  /// The distance from the centre that a share of the square lies below: the inverse of the trapezoid's area that is
  /// the square's shadow across the motion.
  double place_across(double share) const {
    const bool beyond = share > 0.5;
    const double low = beyond ? 1 - share : share, edge = small_ / (2 * large_);  // the share of the trapezoid's ramp
    const double outermost = -0.5 * (large_ + small_);
    const double place =
        low < edge ? outermost + std::sqrt(2 * low * small_ * large_) : outermost + small_ + (low - edge) * large_;
    return beyond ? -place : place;
  }

  bool aligned_ = false;
  double cos_ = 1, sin_ = 0, large_ = 1, small_ = 0;
};

/// For the time-continuous rays of a pixel.
inline AlignedPoints align_points(const MotionMask& mask, int x, int y) {
  const std::optional<double> angle = mask.direction(x, y);
  return angle ? AlignedPoints(*angle) : AlignedPoints();
}

}  // namespace kairos
