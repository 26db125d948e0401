// The first three dimensions of Sobol's sequence, and Owen's nested uniform scrambling of them.
#pragma once

#include <array>
#include <cstdint>

namespace kairos {

/// Fractions in units of 2^-32, with their bits in reverse order: bit 0 is the first binary digit after the point. That
/// order is what scrambling works in.
using ReversedPoint = std::array<uint32_t, 3>;

/// Point `index` of the sequence. Dimensions 0 and 1 are a (0,2)-sequence: any 2^m aligned successive points hit every
/// elementary interval of area 2^-m once. Direction numbers: S. Joe and F. Kuo (2008), dimensions 1 to 3.
ReversedPoint sobol_reversed(uint32_t index);

/// The random decisions of one scrambling: a function of the seed alone.
struct OwenKey {
  uint64_t top;                     ///< one bit for each of the 63 nodes of the tree's first six levels
  uint32_t add_a, add_b;            ///< deeper levels
  uint32_t multiply_a, multiply_b;  ///< odd
};
OwenKey make_owen_key(uint64_t seed);

/// Scrambles one coordinate and puts its bits back in order: a fraction in units of 2^-32.
///
/// Each digit is flipped, or not, by what the digits before it say, which is what keeps the points stratified.
/// Additions and multiplications carry from low to high bits only, so that on reversed bits they are such a map (S.
/// Laine and T. Karras 2011; B. Burley 2020). Alone they leave the flips of the first levels, the ones that a picture
/// shows, strongly dependent on each other; those take independent random bits instead.
inline uint32_t owen_scramble(uint32_t reversed, const OwenKey& key) {
  uint32_t v = reversed;
  v += key.add_a;
  v *= key.multiply_a;
  v ^= v * 0x9e3779b8u;  // even: bit i of the product depends on lower bits only
  v += key.add_b;
  v *= key.multiply_b;
  for (uint32_t level = 0; level < 6; ++level) {
    const uint32_t node = (1u << level) - 1, prefix = reversed & node;
    v ^= (static_cast<uint32_t>(key.top >> (node + prefix)) & 1u) << level;
  }
  v = __builtin_bswap32(v);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  return ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
}

}  // namespace kairos
