// Numbers of 16 bits: one bit for the sign, five for the exponent, ten for the fraction (IEEE 754 binary16).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace kairos {

inline constexpr float kMostHalf = 65504;

/// The nearest one, of two equally near ones the even; what is larger than any becomes the largest. Not for NaN.
inline uint16_t to_half(float value) {
  const float magnitude = std::min(std::bit_cast<float>(std::bit_cast<uint32_t>(value) & 0x7fffffffu), kMostHalf);
  const auto bits = std::bit_cast<uint32_t>(magnitude);
  uint32_t half = 0;
  if (magnitude < 0x1p-14f)
    half =
        std::bit_cast<uint32_t>(magnitude + 0.5f) - std::bit_cast<uint32_t>(0.5f);  // whose ulp is that of small ones
  else
    half = (bits - (112u << 23) + 0xfffu + ((bits >> 13) & 1u)) >> 13;
  return static_cast<uint16_t>(half | (std::bit_cast<uint32_t>(value) >> 16 & 0x8000u));
}

inline float from_half(uint16_t half) {
  // As the float of those bits is, 2^112 times smaller, small ones among them.
  const float magnitude = std::bit_cast<float>((half & 0x7fffu) << 13) * 0x1p112f;
  return (half & 0x8000u) != 0 ? -magnitude : magnitude;
}

/// Is it a number, not an infinity or none?
inline bool is_finite_half(uint16_t half) { return (half & 0x7c00u) != 0x7c00u; }

}  // namespace kairos
