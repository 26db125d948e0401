// From a pixel's signal to the few pieces that are kept of it. docs/time.md.
#pragma once

#include <span>
#include <vector>

#include "film/lanes.h"
#include "film/time_signal.h"
#include "film/time_tile.h"

namespace kairos {

/// Below this, floats would be too coarse to find pieces with.
inline constexpr double kLeastTolerance = 0x1p-18;

/// Appends signals to tiles. One thread's memory, reused from pixel to pixel.
class TimeCoder {
 public:
  /// tolerance: how far, in units of max(1, mean of the channel), the integral of any channel from 0 to any instant may
  /// leave the signal's, at least kLeastTolerance. 0: pieces stay as they are, as floats.
  explicit TimeCoder(double tolerance) : tolerance_(tolerance) {}

  /// shift: see TimeSignal::shift.
  void add(std::span<const SignalPiece> signal, double shift, TimeTile& out);

 private:
  /// A straight line over pieces [first, last) with the mean that the signal has there.
  struct Fit {
    Rgba left, step;
  };

  void integrate(std::span<const SignalPiece> signal);
  Fit fit(size_t first, size_t last) const;
  bool holds(size_t first, size_t last, const Fit& line) const;
  Rgba deviation(size_t first, size_t last, const Fit& line) const;
  size_t longest(size_t first, Fit& line);
  void append(size_t first, const Fit& line, TimeTile& out);
  void append_exactly(std::span<const SignalPiece> signal, TimeTile& out) const;

  double tolerance_;
  std::span<const SignalPiece> signal_;
  /// What one asks of a piece again and again.
  struct Step {
    Lanes sum;     // of the signal, up to its beginning
    Lanes bend;    // its rise times an eighth of its length
    double time;   // at its beginning
    float eighth;  // of the square of its length
  };

  std::vector<double> time_;  // [piece], and the end
  // [piece], and the end: integrals of the signal and of time times the signal, up to its beginning.
  std::vector<Rgba> sum_, moment_;
  std::vector<Step> steps_;  // [piece]
  Rgba scale_{};             // of deviations
  Lanes limit_{};            // of deviations, scaled, without what shifting and computing with floats take
  size_t last_count_ = 1;    // pieces of the signal in the piece before
};

}  // namespace kairos
