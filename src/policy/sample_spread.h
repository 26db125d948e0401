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
