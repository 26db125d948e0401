// How much each instant of the shutter counts.
#pragma once

#include <array>
#include <vector>

#include <kairos/export.h>

namespace kairos {

/// A function of shutter time: straight lines between points, zero outside of them. Integrals are closed forms.
class KAIROS_API TimeWeight {
 public:
  struct Point {
    double time = 0, weight = 0;
  };

  /// A box: 1 from 0 to 1.
  TimeWeight() = default;
  /// points: at least two, of finite numbers, with times from 0 to 1 that do not descend; two of one time make a step.
  /// Throws Error(bad_usage) otherwise.
  explicit TimeWeight(std::vector<Point> points);

  bool is_box() const { return points_.empty(); }
  /// At a step, the value after it.
  double at(double time) const;
  /// The integral over [begin, end], begin <= end.
  double integral(double begin, double end) const;
  /// The integrals over [begin, end] of the weight times (1 - s) and times s, where s goes from 0 to 1 on a straight
  /// line: what the values at both ends of anything linear count.
  std::array<double, 2> moments(double begin, double end) const;
  /// All of it: straight lines between these, of which two of one time make a step; zero outside of them.
  std::vector<Point> points() const;

 private:
  std::vector<Point> points_;  // none: a box
};

}  // namespace kairos
