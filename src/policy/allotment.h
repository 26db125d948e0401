// How many rays of which kind a pixel gets for its share of the budget. docs/method.md, "Static and moving in one
// pixel".
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <kairos/record.h>

#include "policy/ray_prices.h"

namespace kairos {

/// Time-continuous rays are chosen when they are worth this much more than the samples they replace, and those more
/// than they are on average where samples go where they are needed: prices are estimates and vary over the picture, and
/// worth() is for pixels in which nothing but motion makes noise (measured: two rays through foliage are worth 16
/// samples and not 34, sixteen 256 and not 1181). With this value auto was nowhere more than 0.4 dB below discrete
/// samples on hall, fan, kitchen, foliage and wires, with 4 to 256 samples.
inline constexpr double kRequiredGain = 2.5;

/// Rays to what stands still with which a pixel is looked at for edges in front of what moves; none of them pays for a
/// budget below kLeastForStill.
inline uint32_t probe_rays(uint32_t budget) { return std::min(16u, budget / 8); }
inline constexpr uint32_t kLeastForStill = 32;

/// How many discrete samples give the error of `rays` time-continuous ones, where things move by `speed` pixels while
/// the shutter is open: fitted to rendered frames of a static hall with a figure that moves by 0.4 to 110 pixels. The
/// exponent: time-continuous rays gain 6.2 dB per doubling, discrete samples 4.2.
inline constexpr double kSlowest = 0.4, kFastest = 10;  // pixels; between them worth grows with speed
inline double worth(double rays, double speed) {
  if (speed < kSlowest) return rays;
  return (0.6 + std::min(speed, kFastest)) * std::pow(rays, 1.7);
}

/// Time-continuous rays whose number is a power of two may take that much more time than there is: half as many would
/// be a good deal worse.
inline constexpr double kMostOver = 1.12;

/// In [0, 1): spread evenly over any patch of pixels (M. Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018).
inline double dither(int x, int y) {
  const double place = 0.7548776662466927 * x + 0.5698402909980532 * y;
  return place - std::floor(place);
}

/// Spends the time of `budget` discrete samples (at least 1) in pixels in which things move. Points of low discrepancy
/// are at their best in powers of two, so a pixel gets the power of two below what the budget buys or, in that share of
/// pixels for which it then lasts, the one above.
class Allotment {
 public:
  /// discrete_gain: discrete samples go where they are needed, and are so many times as good for it. still_share: how
  /// many still rays a pixel takes beside time-continuous ones, in the mean, as a share of the budget. corrected: do
  /// pixels with time-continuous rays get any?
  Allotment(uint32_t budget, const RayPrices& prices, double discrete_gain = 1, double still_share = 1,
            bool corrected = true)
      : budget_(budget), corrected_(corrected) {
    const double samples = budget, time = samples - samples * still_share * prices.still_ray;
    const auto cost = [&](double rays) { return rays * tc_ray_price(prices, rays); };
    if (!(cost(1) <= kMostOver * time)) return;
    low_ = 1;
    while (2 * low_ <= budget && cost(2.0 * low_) <= kMostOver * time) low_ *= 2;
    const double more = 2 * low_ <= budget ? cost(2.0 * low_) - cost(low_) : 0;
    share_ = more > 0 ? std::clamp((time - cost(low_)) / more, 0.0, 1.0) : 0;  // with twice as many
    mean_cost_ = cost(low_) + share_ * more + samples - time;
    // Errors add up, and are one over what rays are worth: that has one value for all slow motion, and at kSlowest and
    // kFastest the ends of a straight line.
    const auto worth_at = [&](double speed) {
      return 1 / ((1 - share_) / worth(low_, speed) + share_ / worth(2.0 * low_, speed));
    };
    const double required = kRequiredGain * discrete_gain * samples;
    const double at_slowest = worth_at(kSlowest), at_fastest = worth_at(kFastest);
    if (worth_at(0) > required)
      least_speed_ = 0;
    else if (at_fastest > required)
      least_speed_ =
          std::max(kSlowest, kSlowest + (kFastest - kSlowest) * (required - at_slowest) / (at_fastest - at_slowest));
  }

  /// Is the budget worth a time-continuous ray?
  bool buys_tc() const { return low_ > 0; }
  /// Time-continuous rays of a pixel that gets any, in the mean.
  double mean_rays() const { return low_ * (1 + share_); }
  /// What these and the still rays beside them take, in samples: not always the budget.
  double mean_cost() const { return mean_cost_; }
  /// speed: pixels while the shutter is open. chance: of the pixel, in [0, 1).
  PixelPlan plan(double speed, double chance) const {
    if (speed < least_speed_) return {0, budget_};
    return plan_over_time(chance);
  }
  /// The same where there must be time-continuous rays, be they worth it or not.
  PixelPlan plan_over_time(double chance) const {
    return {std::max(1u, chance < share_ ? 2 * low_ : low_), corrected_ ? budget_ : 0};
  }

 private:
  uint32_t budget_, low_ = 0;
  bool corrected_;
  double share_ = 0, mean_cost_ = 0;
  double least_speed_ = std::numeric_limits<double>::infinity();  // at which time-continuous rays are chosen
};

/// Still rays worth tracing in a pixel whose time-continuous rays see the still layer for the share `still` of the
/// shutter: its noise counts by that share.
inline uint32_t still_rays(const PixelPlan& plan, double still) {
  if (still >= 0.5) return std::max(plan.tc_rays, plan.discrete);
  const auto wanted = static_cast<uint32_t>(2 * still * plan.discrete);
  return std::max({1u, plan.tc_rays, std::bit_floor(wanted)});
}

}  // namespace kairos
