// How much of a square a straight edge covers that moves over it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace kairos {

/// An edge that passes over a square of side 1 whose sides are parallel to the axes. docs/events.md, "Edges".
class Coverage {
 public:
  /// cos, sin: of the edge's normal.
  Coverage(double cos, double sin)
      : large_(std::max(std::abs(cos), std::abs(sin))), small_(std::min(std::abs(cos), std::abs(sin))) {
    if (small_ < kParallel) small_ = 0;
  }

  /// Covered part of the square when the edge has gone `way` past the middle, along its normal.
  double at(double way) const {
    const double half = outer(), way_in = half - std::abs(way);
    if (way_in <= 0) return way < 0 ? 0 : 1;
    // Cut off: a corner, or all but one.
    if (std::abs(way) > inner()) {
      const double corner = way_in * way_in / (2 * large_ * small_);
      return way < 0 ? corner : 1 - corner;
    }
    return 0.5 + way / large_;
  }

  /// Where the polynomials of which it is made meet: from -outer() to outer().
  double outer() const { return 0.5 * (large_ + small_); }
  double inner() const { return 0.5 * (large_ - small_); }

 private:
  static constexpr double kParallel = 1e-9;

  double large_, small_;
};

}  // namespace kairos
