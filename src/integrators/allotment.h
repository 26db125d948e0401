// How many rays of which kind a pixel gets for its share of the budget. docs/method.md, "Static and moving in one
// pixel".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kairos {

struct PixelPlan {
  uint32_t tc_rays = 0;   ///< 0: discrete samples of everything instead
  uint32_t discrete = 0;  ///< samples: of what stands still beside time-continuous rays, else of everything
};

/// What rays cost and what they are worth, in units of one discrete sample of a moving scene. Recorded numbers: a
/// picture must not depend on a clock.
struct RayPrices {
  double tc_ray = 8;       ///< time of a time-continuous ray where something moves
  double still_ray = 0.3;  ///< time of a discrete ray to what stands still
};

/// A time-continuous ray is chosen when it is worth this much more than the samples it replaces: prices vary by scene.
inline constexpr double kRequiredGain = 1.3;

/// How many discrete samples give the error of `rays` time-continuous ones, where things move by `speed` pixels while
/// the shutter is open: fitted to rendered frames of a static hall with a figure that moves by 0.4 to 110 pixels. The
/// exponent: time-continuous rays gain 6.2 dB per doubling, discrete samples 4.2.
inline double worth(double rays, double speed) {
  constexpr double kSlowest = 0.4, kFastest = 10;  // pixels; between them worth grows with speed
  if (speed < kSlowest) return rays;
  return (0.6 + std::min(speed, kFastest)) * std::pow(rays, 1.7);
}

/// Spends the time of `budget` discrete samples (at least 1) in a pixel in which things move.
inline PixelPlan allot(uint32_t budget, double speed, const RayPrices& prices) {
  const double samples = budget;
  const double affordable = std::floor(samples * (1 - prices.still_ray) / prices.tc_ray);
  if (affordable >= 1 && worth(affordable, speed) > kRequiredGain * samples)
    return {static_cast<uint32_t>(affordable), budget};
  return {0, budget};
}

}  // namespace kairos
