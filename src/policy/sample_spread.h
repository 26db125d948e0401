// How many discrete samples each pixel gets: few where they all look alike, more where they don't. docs/method.md,
// "Samples where they are needed".
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <kairos/render.h>

#include "math/sampler.h"

namespace kairos {

/// A pixel is looked at with half of the budget first: with a quarter, the edges that are missed cost more than is
/// saved (hall, 64 samples: 50.9 instead of 51.8 dB). Powers of two, since there Owen-Sobol' points are at their best.
inline uint32_t first_samples(uint32_t budget) { return std::bit_floor(std::max(1u, budget / 2)); }
/// No pixel gets more; 64 times the budget is no better than 16.
inline uint32_t most_samples(uint32_t budget) {
  const uint32_t most = std::bit_floor(std::min(budget, Sampler::kMaxCount / 16)) * 16;
  return std::max(budget, most);
}

/// Is the number to depend on the pixel? Fewer than 8 samples say too little of it (and cost almost as much as 8). Of
/// multi-jittered points the first do not fill the pixel.
inline bool spreads_samples(const RenderParams& params) {
  constexpr uint32_t kLeastFirst = 8;
  return params.integrator == IntegratorKind::automatic && params.sampler != SamplerKind::multi_jitter &&
         params.spp > 0 && first_samples(static_cast<uint32_t>(params.spp)) >= kLeastFirst;
}

/// What the first samples of a pixel say.
struct PixelLook {
  double contrast_square = 0;
  /// Of a sample there, of any unit: what is saved where nothing moves buys less where something does. Samples of edges
  /// are about as dear in either place, so it does not decide which pixel gets them.
  double price = 1;
};

/// The rule by which the square of a pixel's contrast gives its number of samples.
class SampleSpread {
 public:
  /// `first` in pixels without contrast, twice as many in most, up to `most` where they are needed; all powers of two.
  /// Together they are to cost what `mean` samples in each of the pixels looked at do.
  SampleSpread(uint32_t first, uint32_t most, double mean, const std::vector<PixelLook>& looks)
      : first_(first), most_(most) {
    double budget = 0;
    for (const PixelLook& look : looks) budget += look.price * mean;
    const auto cost = [&](double scale) {
      scale_ = scale;
      double sum = 0;
      const double usual = 2.0 * first;
      for (const PixelLook& look : looks) {
        const double samples = count(look.contrast_square), more = std::max(0.0, samples - usual);
        // Up to the usual number, which most get, all have a share: else they would lose half if it were a bit too
        // much.
        const double up_to_usual = std::clamp<double>(wanted(look.contrast_square, scale), first, usual);
        sum += look.price * (up_to_usual + kMore * more);
      }
      return sum;
    };
    // From nothing for anybody to all for the least contrast that a display shows.
    double low = 0, high = most * std::pow(kLeastContrast * kLeastContrast, -kExponent);
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2;
      (cost(middle) <= budget * (1 + kRounding) ? low : high) = middle;
    }
    scale_ = low;
  }

  /// In proportion to the sum of squared errors in these pixels.
  double error(const std::vector<PixelLook>& looks) const {
    double sum = 0;
    for (const PixelLook& look : looks)
      sum += look.contrast_square * std::pow(count(look.contrast_square), -kErrorExponent);
    return sum;
  }

  /// How many times the samples it would take to get the same error in these pixels with `mean` in each; at least 1.
  double gain(double mean, const std::vector<PixelLook>& looks) const {
    double alike = 0;
    for (const PixelLook& look : looks) alike += look.contrast_square * std::pow(mean, -kErrorExponent);
    const double spread = error(looks);
    return spread > 0 ? std::max(1.0, std::pow(alike / spread, 1 / kErrorExponent)) : 1;
  }

  /// Does it pay in a lit picture, where these pixels would otherwise have `alike` samples each? The gain is less than
  /// gain() says, since contrasts are those of noisy light, the more so the fewer samples there are; and it takes more
  /// time, since pixels are even because no light gets there, and rays that look for it end soon.
  bool pays_if_lit(double alike, const std::vector<PixelLook>& looks) const {
    double time = 0, time_alike = 0;
    for (const PixelLook& look : looks) {
      const double samples = count(look.contrast_square);
      const double less = std::max(0.0, alike - samples), more = std::max(0.0, samples - alike);
      time += look.price * (alike - kLitSaved * less + kMore * kLitDearer * more);
      time_alike += look.price * alike;
    }
    return 1 + (gain(alike, looks) - 1) * (1 - kOfNoise / first_) > time / time_alike + kSteps;
  }

  /// Samples by which the contrast of a pixel is found.
  uint32_t first() const { return first_; }

  /// Of a pixel. Contrasts are estimates: a pixel that is wrongly given half of the samples loses more than one that is
  /// given twice as many gains, so that either happens only where it is clear.
  uint32_t count(double contrast_square) const {
    const double samples = wanted(contrast_square, scale_);
    uint32_t count = 2 * first_;
    if (samples < kClearlyLess * count) return first_;
    while (count < most_ && samples >= kClearlyMore * count) count *= 2;
    return count;
  }

 private:
  /// The squared error of n Owen-Sobol' samples of an edge with the contrast c is about c^2 n^-1.5. The sum of that
  /// over the picture, for a given sum of n, is least where n goes with (c^2)^0.4.
  static constexpr double kErrorExponent = 1.5, kExponent = 1 / (1 + kErrorExponent);
  /// Contrasts grow as samples are added, so that pixels that get more than usual get more than their first ones said.
  static constexpr double kMore = 1.25;
  static constexpr double kRounding = 1e-9;
  /// What samples of pixels that do with few take beside what their price says, compared with those of usual ones, and
  /// of those that need more: 0.59 to 0.88, and 1 to 1.33, measured on hall, still, marbles, blades and foliage with 16
  /// and 64 samples. And what it takes that the first samples go through the scene by themselves.
  static constexpr double kLitSaved = 0.65, kLitDearer = 1.3, kSteps = 0.03;
  /// Of the gain, by contrasts that know nothing of those by which samples were given, on these, fan and glass.
  static constexpr double kOfNoise = 4;
  /// On the foliage, where all pixels are alike, rounding to the nearest power of two loses 0.5 dB; on the hall these
  /// are within 0.2 dB of the best.
  static constexpr double kClearlyLess = 0.25, kClearlyMore = 1.5;
  static constexpr double kLeastContrast = 1.0 / 256;
  static constexpr int kHalvings = 50;  // of a range of 10^8 samples: closer than one by far

  static double wanted(double contrast_square, double scale) { return scale * std::pow(contrast_square, kExponent); }

  uint32_t first_, most_;
  double scale_ = 0;
};

}  // namespace kairos
