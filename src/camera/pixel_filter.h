// Pixel filters by importance sampling: samples are placed as the filter is shaped and all count alike. No sample is
// shared between pixels, so that each can be rendered without its neighbours.
#pragma once

#include <vector>

#include <kairos/render.h>

namespace kairos {

/// One axis of a separable filter. Immutable.
class PixelFilter {
 public:
  explicit PixelFilter(FilterKind kind);

  /// Half of the filter's width, pixels.
  double radius() const { return radius_; }

  /// Distance from the pixel's centre, pixels, in [-radius, radius]: the inverse of the filter's cumulative
  /// distribution at u in [0, 1). Ascends with u, and so keeps samples stratified. Antisymmetric about u = 1/2.
  double offset(float u) const;

 private:
  double radius_;
  std::vector<float> inverse_;  // offsets at evenly spaced u; empty: box
};

}  // namespace kairos
