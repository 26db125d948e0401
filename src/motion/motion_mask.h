// Where on screen anything moves relative to the camera, and how fast: pixels outside never pay for it.
#pragma once

#include <optional>
#include <vector>

#include <kairos/scene.h>

namespace kairos {

/// Per pixel of the frame, how many moving triangles may be seen in it while the shutter is open, and their mean speed.
/// Conservative: made from the screen bounds of each triangle's path, cut off at the near side, so a pixel that says
/// that nothing moves is right. Meshes with more than one key count as moving as a whole.
///
/// Difference arrays of integers, hence O(triangles + pixels) and the same for any order of summation.
class MotionMask {
 public:
  /// margin: pixels around a pixel's area that its filter reaches.
  MotionMask(const Shot& shot, double margin);

  bool moves(int x, int y) const { return at(count_, x, y) > 0; }
  /// Mean over the triangles that may be seen in the pixel of how far they move on screen, in pixels per shutter.
  double speed(int x, int y) const;
  /// Geometric mean over the same triangles of the depth of the nearest vertex, in scene units; infinity without any.
  double depth(int x, int y) const;
  /// Radians from the first axis of the screen towards the second, of motion there and back alike; nothing where what
  /// moves goes different ways. The same for pixels of a square of four by four.
  std::optional<double> direction(int x, int y) const;
  /// True when no pixel moves.
  bool empty() const { return !any_; }

 private:
  /// Side of the squares of pixels that share a direction.
  static constexpr size_t kCell = 4;
  /// Of `pixels`, and one more.
  static size_t cells(int pixels) { return (static_cast<size_t>(pixels) + kCell - 1) / kCell + 1; }

  /// From differences at corners to sums.
  template <class Number>
  static void sum_up(std::vector<Number>& plane, size_t columns);
  template <class Number>
  Number at(const std::vector<Number>& plane, int x, int y) const {
    return plane[static_cast<size_t>(y) * static_cast<size_t>(width_ + 1) + static_cast<size_t>(x)];
  }

  int width_, height_;
  bool any_ = false;
  std::vector<int32_t> count_;  // one column and one row more than the frame
  std::vector<int64_t> speed_;  // sum, in units of 1 / kSpeedUnits pixels
  std::vector<int64_t> depth_;  // sum of binary logarithms, in units of 1 / kDepthUnits
  // [cell]: sums of weight times the cosine and the sine of twice the direction's angle, and of the weights: speeds.
  std::vector<int64_t> along_, across_, weight_;
};

}  // namespace kairos
