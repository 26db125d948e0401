// How a picture's time is split between pixels with time-continuous rays and pixels with discrete samples alone.
// docs/method.md, "Races".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "policy/race.h"
#include "policy/sample_spread.h"

namespace kairos {

/// A pixel that was looked at.
struct Contestant {
  PixelLook look;
  std::optional<double> speed;  ///< as RacedPixel's; unset: it cannot get time-continuous rays
  /// What is to be spent in the mean over all pixels is the budget times this, in units of the look's price: what a
  /// sample of everything takes there.
  double asked = 1;
};

/// Finds, for each of the race's classes of speed, the number of time-continuous rays or discrete samples alone, such
/// that the estimated sum of squared errors over these pixels is least, if it is clearly less than with the same time
/// for all. error_scale: from SampleSpread::error() to squared errors, of pixels that were not raced.
///
/// Tells the race, and returns the rule for pixels with discrete samples alone; unset: too few to say, they get
/// `budget`.
std::optional<SampleSpread> split_time(Race& race, uint32_t budget, double error_scale,
                                       std::span<const Contestant> pixels);

/// The rule for pixels with so many samples in the mean; unset where there are too few to say.
std::optional<SampleSpread> spread_rest(uint32_t budget, double mean, const std::vector<PixelLook>& looks);

}  // namespace kairos
