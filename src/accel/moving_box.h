// Axis-aligned boxes whose faces move linearly from one time to another.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <kairos/vec.h>

namespace kairos {

/// Twelve bounds, the upper ones negated, so that a union is an element-wise minimum (which compilers vectorise).
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

  /// Twice the centre, averaged over time, on axis 0 to 2; twice the centre's displacement on axis 3 to 5: what
  /// builders sort by, so that things in one place that move differently part company.
  float sort_value(int axis) const {
    const int a = axis % 3;
    const float begin = lower(0, a) + upper(0, a), end = lower(1, a) + upper(1, a);
    return axis < 3 ? 0.5f * (begin + end) : end - begin;
  }

  /// Cost of a node, in units of half a surface. First term: the volume swept by a box of the mean size that moves with
  /// the centre, proportional to the probability that a random line meets the box at *any* time. It is the Minkowski
  /// sum of a box (edges a, b, c) and a motion m, a zonotope whose faces come in pairs |g_i x g_j| of its four
  /// generators. Second term, at half the weight: the mean box, proportional to the time for which the line does. Where
  /// boxes cross each other's paths the first cannot tell whether they are kept apart (docs/method.md, "Builder").
  float cost() const {
    float edge[3], move[3];
    for (int axis = 0; axis < 3; ++axis) {
      edge[axis] = 0.5f * ((upper(0, axis) - lower(0, axis)) + (upper(1, axis) - lower(1, axis)));
      move[axis] = 0.5f * sort_value(axis + 3);
    }
    const float box = edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0];
    const float swept = edge[0] * std::sqrt(move[1] * move[1] + move[2] * move[2]) +
                        edge[1] * std::sqrt(move[2] * move[2] + move[0] * move[0]) +
                        edge[2] * std::sqrt(move[0] * move[0] + move[1] * move[1]);
    return 1.5f * box + swept;
  }
};

}  // namespace kairos
