// Where on lights, and in which directions, shading samples look.
#pragma once

#include <array>

#include "math/hash.h"
#include "math/sobol.h"

namespace kairos {

/// Names one shading sample: the `index`th of those that share a seed, usually a pixel's. Samples of one seed are
/// spread evenly over every light.
struct SampleKey {
  uint64_t seed = 0;
  uint32_t index = 0;

  /// For what belongs to the same sample but must be independent of it: another purpose, or a secondary ray.
  SampleKey branch(uint64_t which) const { return {hash(seed, which), index}; }
};

/// Point of an Owen-scrambled Sobol' sequence, in [0, 1)^3. Keys with other seeds walk through other stretches of the
/// sequence in another order (B. Burley 2020), so that what two of them see together is spread well too.
inline std::array<float, 3> light_point(const SampleKey& key) {
  uint32_t reversed = __builtin_bswap32(key.index);
  reversed = ((reversed >> 4) & 0x0f0f0f0fu) | ((reversed & 0x0f0f0f0fu) << 4);
  reversed = ((reversed >> 2) & 0x33333333u) | ((reversed & 0x33333333u) << 2);
  reversed = ((reversed >> 1) & 0x55555555u) | ((reversed & 0x55555555u) << 1);
  const ReversedPoint point = sobol_reversed(owen_scramble(reversed, make_owen_key(hash(key.seed, 0))));
  std::array<float, 3> result;
  for (size_t i = 0; i < 3; ++i) result[i] = unit_float(owen_scramble(point[i], make_owen_key(hash(key.seed, i + 1))));
  return result;
}

}  // namespace kairos
