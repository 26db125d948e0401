// The signals of a square of pixels, as they are kept: in memory and in files.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kairos {

/// A channel's numbers, or all four of a piece: red, green, blue, coverage.
template <class Number>
using Four = std::array<Number, 4>;

/// How far what is kept of a pixel may be from what it showed, at most: of any of its channels, in units of max(1, mean
/// of the channel). docs/time.md, "The bound".
struct TimeDeviation {
  float integral = 0;    ///< of the integrals from 0 to any instant, before values were rounded
  float rounding = 0;    ///< of values, by which they were rounded
  uint32_t clamped = 0;  ///< values that are too large for 16 bits; `rounding` leaves them out

  void join(const TimeDeviation& other) {
    integral = std::max(integral, other.integral);
    rounding = std::max(rounding, other.rounding);
    clamped += other.clamped;
  }
};

/// Pieces of `Number`s: halves, or floats.
template <class Number>
struct PieceValues {
  std::vector<Four<Number>> left, step;  ///< value at the beginning, and how much more it is at the end
};

/// Signals of pixels, one after the other.
struct TimeTile {
  std::vector<uint32_t> first;   ///< [pixel], and the end of the last one: of its pieces
  std::vector<uint32_t> begin;   ///< [piece]: ticks (see time_signal.h)
  PieceValues<uint16_t> halves;  ///< one of the two is empty
  PieceValues<float> floats;
  TimeDeviation deviation;

  size_t pixels() const { return first.empty() ? 0 : first.size() - 1; }
  size_t pieces() const { return begin.size(); }
  bool exact() const { return !floats.left.empty(); }
  size_t memory_bytes() const {
    return first.size() * 4 + begin.size() * 4 + halves.left.size() * 16 + floats.left.size() * 32;
  }
};

}  // namespace kairos
