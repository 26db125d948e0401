// Deep samples whose composite is an exposure.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <kairos/deep_image.h>

namespace kairos {

/// Distance of the background's sample: behind everything, and finite, since programs do sums with it.
inline constexpr float kBackgroundDistance = 1e10f;

/// Shares out by coverage what of the pixel's colour no sample explains: control variates, rounding, and the tolerance
/// of what is kept.
template <class Sample>
void share_rest(std::vector<Sample>& samples, const Vec3f& rest, double covered) {
  for (Sample& sample : samples)
    sample.colour += rest * static_cast<float>(static_cast<double>(sample.coverage) / covered);
}

/// Samples of one pixel, from front to back: what each contributes becomes what it is, seen through those before it.
class PixelSamples {
 public:
  /// out: with the channels "R", "G", "B", "A", "Z" and "id" before others.
  explicit PixelSamples(DeepImage& out) : out_(out) {}

  /// contribution: to the pixel's colour; coverage: of the pixel. Returns whether there is such a sample.
  bool add(const Vec3f& contribution, double coverage, float depth, uint32_t id) {
    const double left = 1 - covered_, alpha = std::min(coverage / left, 1.0);
    if (!(left > 0 && alpha > 0)) return false;
    if (!(depth > depth_)) depth = std::nextafter(depth_, std::numeric_limits<float>::infinity());
    depth_ = depth;
    covered_ += left * alpha;
    const auto put = [&](size_t channel, double value) {
      out_.image.channels[channel].values.push_back(static_cast<float>(value));
    };
    put(0, static_cast<double>(contribution.x) / left);
    put(1, static_cast<double>(contribution.y) / left);
    put(2, static_cast<double>(contribution.z) / left);
    put(3, alpha);
    put(4, static_cast<double>(depth));
    put(5, id);
    return true;
  }

 private:
  DeepImage& out_;
  double covered_ = 0;
  float depth_ = -std::numeric_limits<float>::infinity();
};

}  // namespace kairos
