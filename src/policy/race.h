// Time-continuous or discrete rays for what moves: whichever was better in a few pixels. docs/method.md, "Races".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace kairos {

/// Pixels are told apart by how fast things move in them, since that decides more than all else. Each of a few hundred
/// pixels is rendered by both kinds of ray for the same price, and by each twice: half of the squared difference of two
/// pictures that know nothing of each other is the error of one of them in the mean.
class Race {
 public:
  /// speed: pixels while the shutter is open. Errors: of the pixel, squared.
  void add(double speed, double tc_error, double discrete_error) {
    Lane& lane = lanes_[lane_of(speed)];
    ++lane.pixels;
    lane.tc += tc_error;
    lane.discrete += discrete_error;
    const double lead = discrete_error - tc_error;
    lane.squared_leads += lead * lead;
  }

  /// Did time-continuous rays win where things move like that? Of speeds that were hardly seen, what the next slower
  /// ones say that were; nowhere, if there are none.
  bool tc_wins(double speed) const {
    for (size_t lane = lane_of(speed) + 1; lane-- > 0;)
      if (lanes_[lane].pixels >= kLeastPixels) return lanes_[lane].is_clear();
    return false;
  }

 private:
  struct Lane {
    size_t pixels = 0;
    double tc = 0, discrete = 0;  // sums of errors
    double squared_leads = 0;     // of time-continuous rays

    bool is_clear() const {
      const auto n = static_cast<double>(pixels);
      const double lead = discrete - tc, variance = squared_leads - lead * lead / n;
      return tc < kClearly * discrete && lead > kDeviations * std::sqrt(std::max(variance, 0.0));
    }
  };
  /// Pixels, while the shutter is open, from which a lane begins.
  static constexpr std::array<double, 5> kBegins{0, 0.4, 1, 3, 10};
  static constexpr size_t kLeastPixels = 24;  // fewer say nothing
  /// A few hundred pixels tell errors to 0.7 dB; a tie goes to discrete samples, which are put where they are needed.
  static constexpr double kClearly = 0.85;
  /// Where a few pixels make most of the error, those that were looked at may be without them: a lead has to be that
  /// much above its own standard error.
  static constexpr double kDeviations = 2.5;

  static size_t lane_of(double speed) {
    const auto above = std::upper_bound(kBegins.begin(), kBegins.end(), std::max(speed, 0.0));
    return static_cast<size_t>(above - kBegins.begin()) - 1;
  }

  std::array<Lane, kBegins.size()> lanes_;
};

}  // namespace kairos
