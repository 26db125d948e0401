#include "math/sobol.h"

#include <cstddef>

#include "math/hash.h"

namespace kairos {

namespace {

uint32_t reverse_bits(uint32_t v) {
  uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= ((v >> bit) & 1u) << (31 - bit);
  return reversed;
}

// [dimension - 1][digit of the index], bits reversed. Dimension 0 is the index itself.
using Directions = std::array<std::array<uint32_t, 32>, 2>;

Directions make_directions() {
  std::array<uint32_t, 32> second{}, third{};
  second[0] = 1u << 31;  // polynomial x + 1, m = {1}
  for (std::size_t i = 1; i < 32; ++i) second[i] = second[i - 1] ^ (second[i - 1] >> 1);
  third[0] = 1u << 31;  // polynomial x^2 + x + 1, m = {1, 3}
  third[1] = 3u << 30;
  for (std::size_t i = 2; i < 32; ++i) third[i] = third[i - 1] ^ third[i - 2] ^ (third[i - 2] >> 2);
  Directions directions;
  for (std::size_t i = 0; i < 32; ++i) {
    directions[0][i] = reverse_bits(second[i]);
    directions[1][i] = reverse_bits(third[i]);
  }
  return directions;
}

}  // namespace

ReversedPoint sobol_reversed(uint32_t index) {
  static const Directions directions = make_directions();
  ReversedPoint point{index, 0, 0};
  for (std::size_t digit = 0; digit < 32; ++digit)
    if ((index >> digit & 1u) != 0) {
      point[1] ^= directions[0][digit];
      point[2] ^= directions[1][digit];
    }
  return point;
}

OwenKey make_owen_key(uint64_t seed) {
  const uint64_t a = hash(seed, 1), b = hash(seed, 2);
  return {hash(seed, 0), static_cast<uint32_t>(a), static_cast<uint32_t>(b), static_cast<uint32_t>(a >> 32) | 1u,
          static_cast<uint32_t>(b >> 32) | 1u};
}

}  // namespace kairos
