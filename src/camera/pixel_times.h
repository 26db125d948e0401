// When a pixel looks: its shutter's interval, and the instants of its discrete rays.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <kairos/time_weight.h>
#include <kairos/tracer.h>

namespace kairos {

class PixelTimes {
 public:
  /// All of the shutter, every instant alike.
  PixelTimes() = default;
  /// weight: nowhere negative, with ends that are floats from 0 to 1.
  explicit PixelTimes(TimeWeight weight)
      : weight_(std::move(weight)),
        window_{static_cast<float>(weight_.begin()), static_cast<float>(weight_.end())},
        sum_(weight_.sum()) {}

  const TimeRange& window() const { return window_; }
  float duration() const { return window_.end - window_.begin; }
  TraceLimits limits() const {
    TraceLimits limits;
    limits.window_begin = window_.begin;
    limits.window_end = window_.end;
    return limits;
  }
  /// The instant of a discrete ray: what is evenly spread from 0 to 1 becomes spread as the weight is.
  float instant(float share) const {
    if (weight_.is_box()) return share;
    return std::clamp(static_cast<float>(weight_.quantile(static_cast<double>(share))), window_.begin,
                      std::nextafter(window_.end, 0.0f));
  }
  /// How densely instants lie there, relative to evenly over all of the shutter; above 0.
  float density(float instant) const {
    if (weight_.is_box()) return 1;
    constexpr double kLeast = 1e-6;  // at the very end of a ramp
    return static_cast<float>(std::max(kLeast, weight_.at(static_cast<double>(instant)) / sum_));
  }

 private:
  TimeWeight weight_;
  TimeRange window_;
  double sum_ = 1;
};

}  // namespace kairos
