// Time-continuous or discrete rays for what moves, and how many: whichever was better in a few pixels.
// docs/method.md, "Races".
#pragma once

#include <algorithm>
#include <array>
#include <bit>
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
  /// Time-continuous rays.
  struct Rays {
    uint32_t count = 0;
    std::array<double, 2> error{};  ///< squared, [with the still layer's correction?]
    double time = 0;                ///< of all of them, without what that correction takes, ns; see tc_ray_time()
  };
  std::array<Rays, 3> tc{};  ///< of raced_counts(), for all pixels of a race the same
  double sample_time = 0;    ///< of one discrete sample, ns; see sample_time()
};

/// As many rays as the budget is thought to buy, a quarter of that and four times as many, for prices may be far off;
/// at most `most`. Of a quarter that is no ray there is one, or, where the budget buys no more, none: 0. thrifty:
/// without four times as many, which take most of a race's time.
inline std::array<uint32_t, 3> raced_counts(double bought, uint32_t most, bool thrifty = false) {
  const auto fits = std::bit_floor(std::clamp(static_cast<uint32_t>(std::lround(bought)), 1u, std::max(most, 1u)));
  const uint32_t few = std::max(1u, fits / 4);
  return {few < fits ? few : 0, fits, thrifty ? 0 : std::min(4 * fits, std::max(most, 1u))};
}

/// Pixels are told apart by how fast things move in them, since that decides more than all else. Each of a few hundred
/// pixels is rendered by both kinds of ray, with and without the still layer's correction, and in each way twice: half
/// of the squared difference of two pictures that know nothing of each other is the error of one of them in the mean.
/// Their work, counted, says what time-continuous rays cost there.
class Race {
 public:
  /// prices: by which the pixels got their time-continuous rays. measured: are they, so that the counts only say where
  /// rays are cheaper or dearer than in the mean? still_share: see Allotment; unset: there is no still layer to
  /// correct.
  Race(uint32_t budget, const RayPrices& prices, bool measured, std::optional<double> still_share)
      : budget_(budget), prices_(prices), measured_(measured), still_share_(still_share) {}

  void add(const RacedPixel& pixel) {
    for (Lane* lane : {&lanes_[lane_of(pixel.speed)], &all_}) {
      lane->sample_time += pixel.sample_time;
      for (size_t i = 0; i < pixel.tc.size(); ++i) {
        const RacedPixel::Rays& from = pixel.tc[i];
        Lane::Rays& to = lane->tc[i];
        for (size_t way = 0; way < kWays; ++way) to.duels[way].add(from.error[way], pixel.discrete_error);
        to.count += from.count;
        to.time += from.time;
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
  /// with, with the still layer's correction or without. Returns whether they won, against as many times the samples;
  /// else, as for 0 times, discrete samples are left.
  bool give(size_t number, double times) {
    Lane& lane = lanes_[number];
    lane.allotment.reset();
    if (!lane.is_seen() || times == 0) return false;
    for (size_t way = 0; way < (still_share_ ? kWays : 1); ++way) {
      const Allotment allotment(static_cast<uint32_t>(std::max(1.0, budget_ * times)), prices_of(lane, way), 1,
                                way == kCorrected ? *still_share_ : 0, way == kCorrected);
      if (!allotment.buys_tc()) continue;
      const double rays = allotment.mean_rays(), error = lane.tc_error(way, rays);
      if ((lane.allotment && error >= lane.error) || !lane.is_won(way, rays, times)) continue;
      lane.allotment = allotment;
      lane.error = error;
    }
    return lane.allotment.has_value();
  }

  /// How time-continuous rays are allotted where things move like that; null: discrete samples won.
  const Allotment* winner(double speed) const {
    const std::optional<size_t> deciding = lane(speed);
    return deciding && lanes_[*deciding].allotment ? &*lanes_[*deciding].allotment : nullptr;
  }

  /// The squared error of a pixel with discrete samples, in the mean over all that were raced.
  double discrete_error() const { return all_.discrete_error(); }
  double discrete_error(size_t number) const { return lanes_[number].discrete_error(); }  ///< of a class
  /// The same of a pixel of a class with the time-continuous rays that it has been given; 0: none.
  double tc_error(size_t number) const { return lanes_[number].allotment ? lanes_[number].error : 0; }
  /// What these take, in discrete samples there.
  double tc_cost(size_t number) const {
    const Lane& lane = lanes_[number];
    return lane.allotment ? lane.allotment->mean_cost() : 0;
  }

  /// Squared errors of discrete samples fall by 4.2 dB per doubling.
  static constexpr double kDiscreteExponent = 1.4;

 private:
  static constexpr size_t kWays = 2, kCorrected = 1;  // the still layer's correction: see RacedPixel

  struct Lane {
    double sample_time = 0;  // summed, as what follows
    struct Rays {
      std::array<Duel, kWays> duels;  // against discrete samples
      double count = 0, time = 0;
    };
    std::array<Rays, 3> tc{};
    std::optional<Allotment> allotment;  // where time-continuous rays won
    double error = 0;                    // theirs

    double pixels() const { return static_cast<double>(tc[1].duels[0].pixels()); }
    bool is_seen() const { return tc[1].duels[0].pixels() >= Duel::kLeastPixels; }
    double discrete_error() const { return tc[1].duels[0].mean_theirs(); }
    double count(size_t which) const { return tc[which].count / pixels(); }
    /// That of the raced counts which is nearest.
    size_t nearest(double rays) const {
      size_t best = 1;
      const auto off = [&](size_t i) { return std::abs(std::log(rays / count(i))); };
      for (size_t i = 0; i < tc.size(); ++i)
        if (tc[i].count > 0 && off(i) < off(best)) best = i;
      return best;
    }
    /// Of a ray, in discrete samples, as counted with the nearest number of them; 0: unknown.
    double counted_price(double rays) const {
      const Rays& like = tc[nearest(rays)];
      return sample_time > 0 ? like.time / like.count / (sample_time / pixels()) : 0;
    }
    /// With which power of their number the squared error falls between two raced counts.
    double exponent(size_t way, size_t low, size_t high) const {
      const double few = tc[low].duels[way].mean_ours(), many = tc[high].duels[way].mean_ours();
      if (!(tc[low].count > 0 && tc[high].count > tc[low].count && few > 0 && many > 0)) return kLeastExponent;
      return std::clamp(std::log(few / many) / std::log(tc[high].count / tc[low].count), kLeastExponent, kMostExponent);
    }
    /// From the error with a raced count to that with so many in each pixel.
    double scale(size_t way, size_t from, double rays) const {
      const bool fewer_known = tc[0].count > 0, more_known = tc[2].count > tc[1].count;
      const size_t low = fewer_known && (!more_known || rays < count(1)) ? 0 : 1;
      return std::pow(rays / count(from), -exponent(way, low, low + 1));
    }
    /// A raced count, and how many times its error is that with so many rays.
    struct Like {
      size_t raced;
      double scale;
    };
    /// The nearest, but for those of more rays that did worse all the same: then a few pixels, which fewer rays
    /// happened to miss, make most of the error.
    Like like(size_t way, double rays) const {
      const size_t near = nearest(rays);
      const auto error_of = [&](const Like& of) { return of.scale * tc[of.raced].duels[way].mean_ours(); };
      Like worst{near, scale(way, near, rays)};
      for (size_t i = 0; i < tc.size(); ++i) {
        if (!(count(i) > rays)) continue;
        const Like more{i, std::pow(count(i) / rays, kLeastExponent)};
        if (error_of(more) > error_of(worst)) worst = more;
      }
      return worst;
    }
    double tc_error(size_t way, double rays) const {
      const Like of = like(way, rays);
      return of.scale * tc[of.raced].duels[way].mean_ours();
    }
    /// Against `times` the samples.
    bool is_won(size_t way, double rays, double times) const {
      const Like of = like(way, rays);
      return tc[of.raced].duels[way].is_won(of.scale, std::pow(times, -kDiscreteExponent));
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

  /// As counted in the class. What was measured holds for all pixels; then counts tell where it is more and where less.
  RayPrices prices_of(const Lane& lane, size_t way) const {
    const RayPrices alone = still_share_ ? without_shares(prices_) : prices_;
    RayPrices prices = alone;
    for (size_t i = 0; i < prices.tc_ray.size(); ++i) {
      const double rays = Calibration::kRays[i], here = lane.counted_price(rays), anywhere = all_.counted_price(rays);
      // Of another number of rays that was raced, it is known as far as the two are alike.
      const double trusted = measured_ ? anywhere : tc_ray_price(alone, lane.count(lane.nearest(rays)));
      if (here > 0 && trusted > 0) prices.tc_ray[i] *= here / trusted;
      if (way == kCorrected) prices.tc_ray[i] += kShareRays / rays;
    }
    return prices;
  }

  uint32_t budget_;
  RayPrices prices_;
  bool measured_;
  std::optional<double> still_share_;
  std::array<Lane, kLanes> lanes_;
  Lane all_;
};

}  // namespace kairos
