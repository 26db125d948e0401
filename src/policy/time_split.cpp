#include "policy/time_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace kairos {

namespace {

constexpr size_t kLeastLooksSeen = 16;  // fewer say nothing of the picture
constexpr double kNearly = 1.25;
/// Fewer samples say too little of a pixel to spread them; where time is saved, more than this help no longer.
constexpr double kLeastMean = 16, kMostOfBudget = 4;
/// What has an error in one pixel of many is easily missed by those looked at, so that few of them cannot say that
/// pixels do with fewer samples: with so many not at all, with twice as many with half as many samples.
constexpr double kLooksForHalf = 64;
/// So much smaller the sum of errors has to be for time to go elsewhere: it is estimated.
constexpr double kClearlyLess = 0.85;
/// Of the budget, for a class of pixels: 0 are discrete samples.
constexpr std::array<double, 12> kTimes{0, 0.25, 0.35, 0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8};
constexpr size_t kDiscrete = 0, kBudget = 5;  // of these
constexpr double kImpossible = std::numeric_limits<double>::infinity();

using Choice = std::array<size_t, Race::kLanes>;  // of kTimes, for each class of speed

double price_of(const std::vector<PixelLook>& looks) {
  double sum = 0;
  for (const PixelLook& look : looks) sum += look.price;
  return sum;
}

/// Of a class, with time-continuous rays: sums over its pixels.
struct Option {
  double error = kImpossible, time = 0;
};

/// Pixels with discrete samples alone.
struct Rest {
  std::vector<PixelLook> looks;
  double price = 0;  // the sum over them
  double error = 0;  // with the budget for each
};

class Split {
 public:
  Split(Race& race, uint32_t budget, double error_scale, std::span<const Contestant> pixels)
      : race_(race), budget_(budget), error_scale_(error_scale) {
    for (const Contestant& pixel : pixels) {
      const std::optional<size_t> lane = pixel.speed ? race.lane(*pixel.speed) : std::nullopt;
      (lane ? lanes_[*lane] : others_).push_back(pixel.look);
      time_ += budget * pixel.asked;
    }
    for (size_t i = 0; i < lanes_.size(); ++i)
      for (size_t k = 1; k < kTimes.size() && !lanes_[i].empty(); ++k)
        if (is_sure_enough(lanes_[i].size(), kTimes[k]) && race_.give(i, kTimes[k]))
          options_[i][k] = {race_.tc_error(i) * static_cast<double>(lanes_[i].size()),
                            race_.tc_cost(i) * price_of(lanes_[i])};
  }

  /// With the budget for all, where time-continuous rays won.
  Choice start() const {
    Choice choice{};
    for (size_t i = 0; i < choice.size(); ++i) choice[i] = options_[i][kBudget].error < kImpossible ? kBudget : 0;
    return choice;
  }

  /// Of all that there are.
  Choice best(const Choice& from) {
    best_ = from;
    least_ = error(from);
    Choice tried{};
    search(0, 0, tried);
    return best_;
  }

  /// The estimated sum of squared errors; infinite for what cannot be.
  double error(const Choice& choice) {
    double sum = 0;
    for (size_t i = 0; i < choice.size(); ++i)
      if (choice[i] != kDiscrete) sum += options_[i][choice[i]].error;
    const Rest& rest = rest_of(choice);
    if (rest.looks.empty()) return sum;
    if (rest.looks.size() < kLeastLooksSeen) return sum + rest.error;
    return sum + rest.error * std::pow(mean_of_rest(choice, rest) / budget_, -Race::kDiscreteExponent);
  }

  /// Tells the race.
  std::optional<SampleSpread> settle(const Choice& choice) {
    const Rest& rest = rest_of(choice);
    double more = 1;
    give(choice, more);
    // What times of kTimes leave over goes to all classes, where hardly a pixel is left to take it.
    for (int round = 0; rest.looks.size() < kLeastLooksSeen && round < kSpendingRounds; ++round) {
      const double used = time_of_rays(choice), spendable = time_ - budget_ * rest.price;
      if (!(used > 0) || std::abs(spendable - used) < kSpent * spendable) break;
      const double before = std::exchange(more, more * spendable / used);
      if (!give(choice, more)) {
        give(choice, before);
        break;
      }
    }
    return rest.looks.empty() ? std::nullopt : spread_rest(budget_, mean_of_rest(choice, rest), rest.looks);
  }

 private:
  /// A class of few pixels is raced in fewer: too few to say how the error goes far from where it was raced.
  static bool is_sure_enough(size_t looks, double times) {
    constexpr size_t kFew = 100;
    return looks >= kFew || (times >= 0.5 && times <= 2);
  }

  /// So many times what was chosen. Returns whether time-continuous rays still win where they are to.
  bool give(const Choice& choice, double more) {
    bool all = true;
    for (size_t i = 0; i < choice.size(); ++i)
      if (!race_.give(i, lanes_[i].empty() ? 0 : more * kTimes[choice[i]])) all = all && choice[i] == kDiscrete;
    return all;
  }
  /// As given.
  double time_of_rays(const Choice& choice) const {
    double time = 0;
    for (size_t i = 0; i < choice.size(); ++i)
      if (choice[i] != kDiscrete) time += race_.tc_cost(i) * price_of(lanes_[i]);
    return time;
  }

  void search(size_t lane, double sum, Choice& tried) {
    if (sum >= least_) return;
    if (lane == lanes_.size()) {
      if (!is_possible(tried)) return;
      const double found = error(tried);
      if (found >= least_) return;
      least_ = found;
      best_ = tried;
      return;
    }
    tried[lane] = kDiscrete;
    search(lane + 1, sum, tried);
    for (size_t k = 1; k < kTimes.size(); ++k) {
      if (!(options_[lane][k].error < kImpossible)) continue;
      tried[lane] = k;
      search(lane + 1, sum + options_[lane][k].error, tried);
    }
    tried[lane] = kDiscrete;
  }

  double time_left(const Choice& choice) const {
    double time = time_;
    for (size_t i = 0; i < choice.size(); ++i)
      if (choice[i] != kDiscrete) time -= options_[i][choice[i]].time;
    return time;
  }
  /// Samples for each pixel of the rest.
  double mean_of_rest(const Choice& choice, const Rest& rest) const {
    return std::clamp(time_left(choice) / rest.price, least_mean(rest), kMostOfBudget * budget_);
  }
  double least_mean(const Rest& rest) const {
    const double share = std::min(1.0, kLooksForHalf / static_cast<double>(rest.looks.size()));
    return std::max(std::min<double>(budget_, kLeastMean), share * budget_);
  }
  bool is_possible(const Choice& choice) {
    const Rest& rest = rest_of(choice);
    const double left = time_left(choice);
    if (rest.looks.size() < kLeastLooksSeen) return left >= budget_ * rest.price - kRounding * time_;
    return left >= least_mean(rest) * rest.price;
  }

  const Rest& rest_of(const Choice& choice) {
    size_t which = 0;
    for (size_t i = 0; i < choice.size(); ++i) which |= size_t{choice[i] == kDiscrete} << i;
    std::optional<Rest>& known = rests_[which];
    if (known) return *known;
    Rest& rest = known.emplace();
    rest.looks = others_;
    for (size_t i = 0; i < choice.size(); ++i)
      if (choice[i] == kDiscrete) rest.looks.insert(rest.looks.end(), lanes_[i].begin(), lanes_[i].end());
    rest.price = price_of(rest.looks);
    if (const auto spread = spread_rest(budget_, budget_, rest.looks))
      rest.error = error_scale_ * spread->error(others_);
    for (size_t i = 0; i < choice.size(); ++i)
      if (choice[i] == kDiscrete) rest.error += race_.discrete_error(i) * static_cast<double>(lanes_[i].size());
    return rest;
  }

  static constexpr double kRounding = 1e-9, kSpent = 0.02;
  static constexpr int kSpendingRounds = 4;

  Race& race_;
  uint32_t budget_;
  double error_scale_;
  std::array<std::vector<PixelLook>, Race::kLanes> lanes_;
  std::vector<PixelLook> others_;
  double time_ = 0;  // for all of them
  std::array<std::array<Option, kTimes.size()>, Race::kLanes> options_;
  std::array<std::optional<Rest>, size_t{1} << Race::kLanes> rests_;  // by the classes that are among them
  Choice best_{};
  double least_ = kImpossible;
};

}  // namespace

std::optional<SampleSpread> split_time(Race& race, uint32_t budget, double error_scale,
                                       std::span<const Contestant> pixels) {
  Split split(race, budget, error_scale, pixels);
  const Choice start = split.start(), best = split.best(start);
  return split.settle(split.error(best) < kClearlyLess * split.error(start) ? best : start);
}

std::optional<SampleSpread> spread_rest(uint32_t budget, double mean, const std::vector<PixelLook>& looks) {
  if (looks.size() < kLeastLooksSeen) return std::nullopt;
  // A little less than a power of two is as good as that.
  const auto nearly = static_cast<uint32_t>(std::lround(kNearly * mean));
  return SampleSpread(first_samples(nearly), most_samples(budget), mean, looks);
}

}  // namespace kairos
