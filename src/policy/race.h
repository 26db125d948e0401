// Time-continuous or discrete rays for what moves, and how many: whichever was better in a few pixels.
// docs/method.md, "Races".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "policy/allotment.h"
#include "policy/duel.h"
#include "policy/ray_prices.h"

namespace kairos {

/// What both kinds of ray did in one pixel, in the mean over two pictures of it.
struct RacedPixel {
  double speed = 0;           ///< pixels while the shutter is open
  double discrete_error = 0;  ///< squared, of the samples that the budget buys
  /// As many rays as the budget is thought to buy, and four times as many.
  struct Rays {
    uint32_t count = 0;
    double error = 0;  ///< squared
    double time = 0;   ///< of all of them, with the discrete rays that come with them, ns; see tc_ray_time()
  };
  std::array<Rays, 2> tc{};
  double sample_time = 0;  ///< of one discrete sample, ns; see sample_time()
};

/// Pixels are told apart by how fast things move in them, since that decides more than all else. Each of a few hundred
/// pixels is rendered by both kinds of ray, and in each way twice: half of the squared difference of two pictures that
/// know nothing of each other is the error of one of them in the mean. Their work, counted, says what time-continuous
/// rays cost there.
class Race {
 public:
  /// still_share: see Allotment. prices: by which the pixels got their time-continuous rays. measured: are they, so
  /// that the counts only say where rays are cheaper or dearer than in the mean?
  Race(uint32_t budget, const RayPrices& prices, bool measured, double still_share)
      : budget_(budget), prices_(prices), measured_(measured), still_share_(still_share) {}

  void add(const RacedPixel& pixel) {
    for (Lane* lane : {&lanes_[lane_of(pixel.speed)], &all_}) {
      lane->sample_time += pixel.sample_time;
      for (size_t i = 0; i < pixel.tc.size(); ++i) {
        const RacedPixel::Rays& from = pixel.tc[i];
        Lane::Rays& to = lane->tc[i];
        to.duel.add(from.error, pixel.discrete_error);
        to.count += from.count;
        to.time += from.time;
        to.estimated += from.count * tc_ray_price(prices_, from.count);
      }
    }
  }

  static constexpr size_t kLanes = 5;  ///< classes of speed
  /// That which decides for a speed: of those that were hardly seen, the next slower one that was; unset: none was.
  std::optional<size_t> lane(double speed) const {
    for (size_t lane = lane_of(speed) + 1; lane-- > 0;)
      if (lanes_[lane].is_seen()) return lane;
    return std::nullopt;
  }

  /// After the last pixel: gives those of a class time-continuous rays for `times` the budget that they were raced
  /// with. Returns whether they won, against as many times the samples; else, as for 0 times, discrete samples are
  /// left.
  bool give(size_t number, double times) {
    Lane& lane = lanes_[number];
    lane.allotment.reset();
    if (!lane.is_seen() || times == 0) return false;
    const double trusted = measured_ && all_.dearer() > 0 ? all_.dearer() : 1, dearer = lane.dearer() / trusted;
    RayPrices prices = prices_;
    if (dearer > 0)
      for (double& price : prices.tc_ray) price *= dearer;
    const Allotment allotment(static_cast<uint32_t>(std::max(1.0, budget_ * times)), prices, 1, still_share_);
    if (allotment.buys_tc() && lane.is_won(allotment.mean_rays(), times)) lane.allotment = allotment;
    return lane.allotment.has_value();
  }

  /// How time-continuous rays are allotted where things move like that; null: discrete samples won.
  const Allotment* winner(double speed) const {
    const std::optional<size_t> deciding = lane(speed);
    return deciding && lanes_[*deciding].allotment ? &*lanes_[*deciding].allotment : nullptr;
  }

  /// The squared error of a pixel with discrete samples, in the mean over all that were raced.
  double discrete_error() const { return all_.tc[0].duel.mean_theirs(); }
  double discrete_error(size_t number) const { return lanes_[number].tc[0].duel.mean_theirs(); }  ///< of a class
  /// The same of a pixel of a class with the time-continuous rays that it has been given; 0: none.
  double tc_error(size_t number) const {
    const Lane& lane = lanes_[number];
    return lane.allotment ? lane.tc_error(lane.allotment->mean_rays()) : 0;
  }

  /// Squared errors of discrete samples fall by 4.2 dB per doubling.
  static constexpr double kDiscreteExponent = 1.4;

 private:
  struct Lane {
    double sample_time = 0;  // summed, as what follows
    struct Rays {
      Duel duel;  // against discrete samples
      double count = 0, time = 0;
      double estimated = 0;  // cost in samples
    };
    std::array<Rays, 2> tc{};
    std::optional<Allotment> allotment;  // where time-continuous rays won

    double pixels() const { return static_cast<double>(tc[0].duel.pixels()); }
    bool is_seen() const { return tc[0].duel.pixels() >= Duel::kLeastPixels; }
    /// How many times as dear as estimated time-continuous rays are; 0: unknown.
    double dearer() const {
      const double samples = (tc[0].estimated + tc[1].estimated) * sample_time / pixels();
      return samples > 0 ? (tc[0].time + tc[1].time) / samples : 0;
    }
    /// With which power of their number the squared error falls.
    double exponent() const {
      const double few = tc[0].duel.mean_ours(), many = tc[1].duel.mean_ours();
      if (!(tc[1].count > tc[0].count && few > 0 && many > 0)) return kLeastExponent;
      return std::clamp(std::log(few / many) / std::log(tc[1].count / tc[0].count), kLeastExponent, kMostExponent);
    }
    /// Those whose number is nearer.
    const Rays& nearer(double rays) const {
      return std::pow(rays * pixels(), 2) < tc[0].count * tc[1].count ? tc[0] : tc[1];
    }
    /// From the error with `from` to that with so many in each pixel.
    double scale(const Rays& from, double rays) const { return std::pow(rays * pixels() / from.count, -exponent()); }
    double tc_error(double rays) const {
      const Rays& from = nearer(rays);
      return scale(from, rays) * from.duel.mean_ours();
    }
    /// Against `times` the samples.
    bool is_won(double rays, double times) const {
      const Rays& from = nearer(rays);
      return from.duel.is_won(scale(from, rays), std::pow(times, -kDiscreteExponent));
    }
  };
  /// Pixels, while the shutter is open, from which a lane begins.
  static constexpr std::array<double, kLanes> kBegins{0, 0.4, 1, 3, 10};
  /// Squared errors of time-continuous rays fall with a power of their number within these.
  static constexpr double kLeastExponent = 0.8, kMostExponent = 3;

  static size_t lane_of(double speed) {
    const auto above = std::upper_bound(kBegins.begin(), kBegins.end(), std::max(speed, 0.0));
    return static_cast<size_t>(above - kBegins.begin()) - 1;
  }

  uint32_t budget_;
  RayPrices prices_;
  bool measured_;
  double still_share_;
  std::array<Lane, kLanes> lanes_;
  Lane all_;
};

}  // namespace kairos
