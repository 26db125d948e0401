// Where a ray that sees through many blended surfaces ends.
#pragma once

#include <algorithm>

namespace kairos {

/// The share of light from behind below which chance decides whether a ray goes on.
inline constexpr float kLeastOpen = 1.0f / 1024;

/// The opacity to use for a surface in place of its own: another one where it would leave less than kLeastOpen of
/// `open`, the share that reaches it (at least kLeastOpen). Then all ends here, or else kLeastOpen goes on: in the mean
/// over `chance`, uniform in [0, 1), as much as without, and so is what is seen of the surface itself. The expected
/// number of surfaces that a ray goes through is bounded by their opacity, however many there are.
inline float roulette(float open, float opacity, float chance) {
  const float after = open * (1 - opacity);
  if (!(after > 0 && after < kLeastOpen)) return opacity;
  return chance * kLeastOpen < after ? std::max(0.0f, 1 - kLeastOpen / open) : 1.0f;
}

}  // namespace kairos
