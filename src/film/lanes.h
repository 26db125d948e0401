// All channels of a pixel at once.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "film/time_tile.h"

namespace kairos {

/// Four floats that are computed with at once.
using Lanes = float __attribute__((vector_size(16)));
using LaneBits = uint32_t __attribute__((vector_size(16)));

inline Lanes load_lanes(const Four<float>& values) {
  Lanes lanes;
  std::memcpy(&lanes, values.data(), sizeof lanes);
  return lanes;
}

/// from_half (half.h) of all four.
inline Lanes load_lanes(const Four<uint16_t>& halves) {
  uint16_t __attribute__((vector_size(8))) packed;
  std::memcpy(&packed, halves.data(), sizeof packed);
  const LaneBits bits = __builtin_convertvector(packed, LaneBits);
  const Lanes magnitude = std::bit_cast<Lanes>((bits & 0x7fffu) << 13) * 0x1p112f;
  return std::bit_cast<Lanes>(std::bit_cast<LaneBits>(magnitude) | (bits & 0x8000u) << 16);
}

inline Lanes absolute(Lanes lanes) { return std::bit_cast<Lanes>(std::bit_cast<LaneBits>(lanes) & 0x7fffffffu); }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }

}  // namespace kairos
