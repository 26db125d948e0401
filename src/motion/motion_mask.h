// Where on screen anything moves relative to the camera, and how fast: pixels outside never pay for it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <kairos/render.h>

#include "motion/screen_motion.h"

namespace kairos {

/// Per pixel of a part of the frame, how many moving triangles may be seen in it while the shutter is open, their mean
/// speed, depth and direction. Conservative, so a pixel that says that nothing moves is right.
///
/// What it says of a pixel does not depend on the part. Difference arrays of integers, hence O(triangles + pixels).
class MotionMask {
 public:
  /// part: of the frame, not empty.
  MotionMask(std::shared_ptr<const ScreenMotion> motion, const Crop& part);

  /// Of a pixel of the part, or of one of the look_pixels() of the frame: what of others is asked is undefined.
  PixelMotion at(int x, int y) const;

  bool moves(int x, int y) const { return at(x, y).moves(); }
  /// See PixelMotion.
  double speed(int x, int y) const { return at(x, y).mean_speed(); }
  double depth(int x, int y) const { return at(x, y).mean_depth(); }
  std::optional<double> direction(int x, int y) const { return at(x, y).direction(); }
  /// True when no pixel of the whole frame moves.
  bool empty() const { return motion_->empty(); }

  /// The part that pixels may be asked of: the one given, grown to whole squares that share a direction.
  const Crop& part() const { return part_; }

 private:
  /// Sums, for each pixel and for each square; before that, differences at corners.
  struct InPixel {
    int64_t count = 0, speed = 0, depth = 0;
  };
  struct InCell {
    int64_t along = 0, across = 0, weight = 0;
  };

  void add(const TriangleOnScreen& triangle);

  std::shared_ptr<const ScreenMotion> motion_;
  Crop part_;
  size_t columns_, cell_columns_;  // one more than the part has
  std::vector<InPixel> pixels_;
  std::vector<InCell> cells_;
};

}  // namespace kairos
