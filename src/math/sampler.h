// Where in the pixel, and when, samples are taken.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <kairos/render.h>

#include "math/sobol.h"

namespace kairos {

struct SamplePoint {
  float x = 0, y = 0, time = 0;  ///< all in [0, 1)
};

/// The same `count` samples per pixel for all pixels, scrambled (or jittered) differently in each: a function of
/// (pixel, seed, sample) alone, so that crops and tiles agree with the full frame. Immutable.
class Sampler {
 public:
  /// count: 1 to kMaxCount; throws Error(bad_usage) otherwise.
  Sampler(SamplerKind kind, uint32_t count, uint64_t seed);
  static constexpr uint32_t kMaxCount = 1u << 20;

  uint32_t count() const { return count_; }

  /// What the samples of one pixel share.
  struct Pixel {
    uint64_t seed = 0;
    std::array<OwenKey, 3> owen{};
  };
  /// x, y: in the full frame.
  Pixel pixel(int x, int y) const;

  /// index below count().
  SamplePoint point(const Pixel& pixel, uint32_t index) const;

 private:
  SamplePoint multi_jittered(uint64_t seed, uint32_t index) const;

  SamplerKind kind_;
  uint32_t count_;
  uint64_t seed_;
  std::vector<ReversedPoint> sobol_;  // [index]: generated once, not once per pixel
  uint32_t columns_ = 1, rows_ = 1;   // multi-jitter: columns_ * rows_ >= count_
};

}  // namespace kairos
