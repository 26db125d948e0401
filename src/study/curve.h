// Quality against time, between the points that were measured.
#pragma once

#include <optional>
#include <vector>

namespace kairos::study {

struct CurvePoint {
  double seconds = 0;  ///< of rendering, > 0
  double psnr = 0;     ///< decibels
};

/// Straight lines between measured points, over the logarithm of time. A curve ends where its measurements end: it goes
/// on along its first and last stretch for a factor of kReach in time, and no farther.
class Curve {
 public:
  static constexpr double kReach = 1.25;

  /// In any order. Points that are not finite, or took no time, are left out; of several with the same time the best
  /// counts.
  explicit Curve(std::vector<CurvePoint> points);

  /// Nothing where the curve does not reach.
  std::optional<double> psnr_at(double seconds) const;
  /// The least time at which the curve is at `psnr`; nothing where it never comes there, or is above it from the start.
  std::optional<double> seconds_at(double psnr) const;

 private:
  std::vector<CurvePoint> points_;  // ascending in time
};

}  // namespace kairos::study
