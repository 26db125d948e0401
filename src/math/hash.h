// Hashing of small tuples of integers: how seeds are made, so that no result depends on the order of work.
#pragma once

#include <cstdint>

namespace kairos {

/// Bijection of the 64-bit integers with full avalanche (the finaliser of SplitMix64, variant 13 of D. Stafford's
/// list).
inline uint64_t mix64(uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

/// Hash of any number of integers; their order counts.
template <class... Rest>
uint64_t hash(uint64_t first, Rest... rest) {
  constexpr uint64_t kGolden = 0x9e3779b97f4a7c15u;  // odd, without structure: zero must not map to zero
  uint64_t h = mix64(first + kGolden);
  ((h = mix64(h + kGolden + static_cast<uint64_t>(rest))), ...);
  return h;
}

/// The upper 24 bits as a number in [0, 1): every result is exact in float, and below 1.
inline float unit_float(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }
inline float unit_float(uint64_t bits) { return unit_float(static_cast<uint32_t>(bits >> 32)); }

}  // namespace kairos
