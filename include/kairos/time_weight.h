// How much each instant of the shutter counts.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <kairos/export.h>

namespace kairos {

/// A function of shutter time: straight lines between points, zero outside of them. Integrals are closed forms. Copies
/// share their points.
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

  /// This weight's times 0 to 1 laid over `begin` to `end`, and `scale` times its values: scale x w((t - begin) / (end
  /// - begin)). begin < end, scale finite; throws Error(bad_usage) otherwise.
  TimeWeight stretched(double begin, double end, double scale) const;

  bool is_box() const { return !curve_; }
  /// At a step, the value after it.
  double at(double time) const;
  /// The integral over [begin, end], begin <= end.
  double integral(double begin, double end) const;
  /// The integrals over [begin, end] of the weight times (1 - s) and times s, where s goes from 0 to 1 on a straight
  /// line: what the values at both ends of anything linear count.
  std::array<double, 2> moments(double begin, double end) const;
  /// All of it: straight lines between these, of which two of one time make a step; zero outside of them.
  std::vector<Point> points() const;

  /// Before and after these it is zero.
  double begin() const { return begin_; }
  double end() const { return begin_ + length_; }
  /// The integral over all of it.
  double sum() const;
  /// The sum of all rises and falls, those from and to zero at both ends among them: the total variation.
  double variation() const;
  /// Where `share`, 0 to 1, of the sum has passed, for weights that are nowhere negative: of a uniform random share, an
  /// instant with the weight over its sum for density.
  double quantile(double share) const;
  /// Is it negative anywhere?
  bool has_negative() const;

 private:
  struct Curve;

  std::shared_ptr<const Curve> curve_;         // none: a box
  double begin_ = 0, length_ = 1, scale_ = 1;  // what the curve's times 0 to 1 are laid over
};

}  // namespace kairos
