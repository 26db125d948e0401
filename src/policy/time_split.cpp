#include "policy/time_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace kairos {

namespace {

constexpr size_t kLeastLooksSeen = 16;  // fewer say nothing of the picture
/// Fewer samples say too little of a pixel to spread them; where time is saved, more than this help no longer.
constexpr double kLeastMean = 16, kMostOfBudget = 4;
/// So much smaller the sum of errors has to be for time to go elsewhere: it is estimated.
constexpr double kClearlyLess = 0.85;
/// Of the budget, for a class of pixels: 0 are discrete samples.
constexpr std::array<double, 12> kTimes{0, 0.25, 0.35, 0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8};
constexpr int kMostRounds = 6;
constexpr double kImpossible = std::numeric_limits<double>::infinity();

using Times = std::array<double, Race::kLanes>;  // of each class of speed

class Split {
 public:
  Split(Race& race, uint32_t budget, double error_scale, std::span<const Contestant> pixels)
      : race_(race), budget_(budget), error_scale_(error_scale) {
    for (const Contestant& pixel : pixels) {
      const std::optional<size_t> lane = pixel.speed ? race.lane(*pixel.speed) : std::nullopt;
      (lane ? lanes_[*lane] : others_).push_back(pixel.look);
      if (!lane) others_price_ += pixel.price;
    }
  }

  /// With the time that it was raced with, where time-continuous rays won.
  Times start() {
    Times times{};
    for (size_t i = 0; i < times.size(); ++i) times[i] = race_.give(i, 1) ? 1 : 0;
    return times;
  }

  /// Improves one class after the other as long as that helps.
  Times best(const Times& from) {
    Times best = from;
    double least = error(best);
    bool better = true;
    for (int round = 0; better && round < kMostRounds; ++round) {
      better = false;
      for (size_t i = 0; i < best.size(); ++i) {
        if (lanes_[i].empty()) continue;
        for (const double times : kTimes) {
          Times tried = best;
          tried[i] = times;
          const double found = error(tried);
          if (found >= least) continue;
          best = tried;
          least = found;
          better = true;
        }
      }
    }
    return best;
  }

  /// The estimated sum of squared errors; infinite for what cannot be.
  double error(const Times& times) {
    double sum = 0;
    for (size_t i = 0; i < times.size(); ++i) {
      if (times[i] == 0 || lanes_[i].empty()) continue;
      if (!race_.give(i, times[i])) return kImpossible;
      sum += race_.tc_error(i) * static_cast<double>(lanes_[i].size());
    }
    const Rest& rest = rest_of(times);
    if (rest.looks.empty()) return time_left(times) >= -kRounding ? sum : kImpossible;
    const double mean = time_left(times) / rest.price;
    const bool is_start = std::all_of(times.begin(), times.end(), [](double t) { return t == 0 || t == 1; });
    if (!is_start && (rest.looks.size() < kLeastLooksSeen || mean < kLeastMean || mean > kMostOfBudget * budget_))
      return kImpossible;
    return sum + rest.error * std::pow(mean / budget_, -Race::kDiscreteExponent);
  }

  /// Tells the race.
  std::optional<SampleSpread> settle(const Times& times) {
    for (size_t i = 0; i < times.size(); ++i) race_.give(i, times[i]);
    const Rest& rest = rest_of(times);
    return rest.looks.empty() ? std::nullopt : spread_rest(budget_, time_left(times) / rest.price, rest.looks);
  }

 private:
  static constexpr double kRounding = 1e-9;

  /// Pixels with discrete samples alone.
  struct Rest {
    std::vector<PixelLook> looks;
    double price = 0;  // the sum over them
    double error = 0;  // with the budget for each
  };

  static double price_of(const std::vector<PixelLook>& looks) {
    double sum = 0;
    for (const PixelLook& look : looks) sum += look.price;
    return sum;
  }

  /// In samples, for the rest.
  double time_left(const Times& times) const {
    double time = budget_ * others_price_;
    for (size_t i = 0; i < times.size(); ++i) time += budget_ * price_of(lanes_[i]) * (1 - times[i]);
    return time;
  }

  const Rest& rest_of(const Times& times) {
    uint32_t which = 0;
    for (size_t i = 0; i < times.size(); ++i) which |= uint32_t{times[i] == 0} << i;
    const auto [at, is_new] = rests_.try_emplace(which);
    Rest& rest = at->second;
    if (!is_new) return rest;
    rest.looks = others_;
    for (size_t i = 0; i < times.size(); ++i)
      if (times[i] == 0) rest.looks.insert(rest.looks.end(), lanes_[i].begin(), lanes_[i].end());
    rest.price = price_of(rest.looks);
    if (const auto spread = spread_rest(budget_, budget_, rest.looks))
      rest.error = error_scale_ * spread->error(others_);
    for (size_t i = 0; i < times.size(); ++i)
      if (times[i] == 0) rest.error += race_.discrete_error(i) * static_cast<double>(lanes_[i].size());
    return rest;
  }

  Race& race_;
  uint32_t budget_;
  double error_scale_;
  std::array<std::vector<PixelLook>, Race::kLanes> lanes_;
  std::vector<PixelLook> others_;
  double others_price_ = 0;         // of samples alone
  std::map<uint32_t, Rest> rests_;  // by the classes that are among them
};

}  // namespace

std::optional<SampleSpread> split_time(Race& race, uint32_t budget, double error_scale,
                                       std::span<const Contestant> pixels) {
  Split split(race, budget, error_scale, pixels);
  const Times start = split.start(), best = split.best(start);
  return split.settle(split.error(best) < kClearlyLess * split.error(start) ? best : start);
}

std::optional<SampleSpread> spread_rest(uint32_t budget, double mean, const std::vector<PixelLook>& looks) {
  if (looks.size() < kLeastLooksSeen) return std::nullopt;
  return SampleSpread(first_samples(static_cast<uint32_t>(std::lround(mean))), most_samples(budget), mean, looks);
}

}  // namespace kairos
