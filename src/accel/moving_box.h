// Axis-aligned boxes whose faces move linearly from one time to another.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include <kairos/vec.h>

namespace kairos {

/// Twelve bounds, the upper ones negated, so that a union is an element-wise minimum.
struct MovingBox {
  std::array<float, 12> bound;  ///< lower at begin (3), -upper at begin (3), lower at end (3), -upper at end (3)

  static MovingBox empty() {
    MovingBox box;
    box.bound.fill(std::numeric_limits<float>::infinity());
    return box;
  }
  /// key 0: begin, 1: end.
  void include(int key, Vec3f p) {
    for (int axis = 0; axis < 3; ++axis) {
      float& lo = bound[static_cast<size_t>(6 * key + axis)];
      float& hi = bound[static_cast<size_t>(6 * key + 3 + axis)];
      lo = std::min(lo, p[axis]);
      hi = std::min(hi, -p[axis]);
    }
  }
  void include(const MovingBox& other) {
    for (size_t i = 0; i < bound.size(); ++i) bound[i] = std::min(bound[i], other.bound[i]);
  }
  float lower(int key, int axis) const { return bound[static_cast<size_t>(6 * key + axis)]; }
  float upper(int key, int axis) const { return -bound[static_cast<size_t>(6 * key + 3 + axis)]; }
};

}  // namespace kairos
