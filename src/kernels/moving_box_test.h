// A ray against one moving, scaling box: the scalar reference in double. docs/method.md, "Ray against moving box".
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <kairos/vec.h>

namespace kairos {

/// When a ray meets a box, and from which distance on.
struct BoxInterval {
  double begin, end;  ///< 0 <= begin <= end <= 1
  double dist;        ///< lower bound of the distance to the box in [begin, end], not below 0
};

/// Exact up to double rounding, for any finite ray and box (lower <= upper at both ends). Flat boxes, boxes around the
/// origin and directions with zero components are as good as others: the nine conditions are linear in time and use no
/// reciprocal.
///
/// With the direction mirrored to be non-negative, slab k is entered at near_k / d_k and left at far_k / d_k. The box
/// is met when every slab is entered before any other is left (near_j d_k <= far_k d_j) and none is left behind the
/// origin (far_k >= 0).
inline std::optional<BoxInterval> intersect_moving_box(Vec3d origin, Vec3d direction, const Vec3d lower[2],
                                                       const Vec3d upper[2]) {
  double near[2][3], far[2][3], d[3];
  for (int k = 0; k < 3; ++k) {
    const bool mirrored = direction[k] < 0;
    d[k] = std::abs(direction[k]);
    for (size_t key = 0; key < 2; ++key) {
      const double lo = lower[key][k] - origin[k], hi = upper[key][k] - origin[k];
      near[key][k] = mirrored ? -hi : lo;
      far[key][k] = mirrored ? -lo : hi;
    }
  }
  double begin = 0, end = 1;
  bool met = true;
  const auto require = [&](double at_begin, double at_end) {  // the linear function must not be negative
    if (at_begin < 0 && at_end < 0)
      met = false;
    else if (at_begin < 0)
      begin = std::max(begin, at_begin / (at_begin - at_end));
    else if (at_end < 0)
      end = std::min(end, at_begin / (at_begin - at_end));
  };
  for (size_t k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      require(-near[0][k], -near[1][k]);
    }
    require(far[0][k], far[1][k]);
    for (size_t j = 0; j < 3; ++j)
      if (j != k) require(far[0][k] * d[j] - near[0][j] * d[k], far[1][k] * d[j] - near[1][j] * d[k]);
  }
  if (!met || begin > end) return std::nullopt;
  double dist = 0;
  for (size_t k = 0; k < 3; ++k) {
    if (d[k] == 0) continue;
    const auto entry = [&](double time) { return (near[0][k] + time * (near[1][k] - near[0][k])) / d[k]; };
    dist = std::max(dist, std::min(entry(begin), entry(end)));
  }
  return BoxInterval{begin, end, dist};
}

}  // namespace kairos
