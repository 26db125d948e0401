// The bounds of what an affine map places.
#pragma once

#include <algorithm>
#include <cstddef>

#include <kairos/affine_map.h>

namespace kairos {

/// The smallest and the largest coordinate along `axis` that AffineMap::point gives to a point of the box. Sums are in
/// that function's order: rounding keeps order, so the smallest terms make the smallest sum, to the last bit.
struct PlacedExtent {
  float lower, upper;

  PlacedExtent(const AffineMap& map, size_t axis, const float (&low)[3], const float (&high)[3]) {
    const Vec4f& row = map.rows[axis];
    const float factor[3] = {row.x, row.y, row.z};
    float least[3], most[3];
    for (size_t k = 0; k < 3; ++k) {
      const float a = factor[k] * low[k], b = factor[k] * high[k];
      least[k] = std::min(a, b);
      most[k] = std::max(a, b);
    }
    lower = ((least[0] + least[1]) + least[2]) + row.w;
    upper = ((most[0] + most[1]) + most[2]) + row.w;
  }
};

}  // namespace kairos
