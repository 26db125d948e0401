// Film points to rays in camera space.
#pragma once

#include <cmath>

#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos {

/// Rays have a direction of (x, y, -1), so that their `dist` is the distance along the view axis.
class CameraRays {
 public:
  explicit CameraRays(const Projection& projection)
      : orthographic_(projection.orthographic),
        half_height_(orthographic_ ? projection.view_height / 2 : std::tan(projection.vfov / 2)),
        half_width_(half_height_ * projection.width / projection.height),
        width_(projection.width),
        height_(projection.height) {}

  /// x, y: pixels from the frame's upper left corner.
  Ray at(double x, double y) const {
    const auto u = static_cast<float>((2 * x / width_ - 1) * half_width_);
    const auto v = static_cast<float>((1 - 2 * y / height_) * half_height_);
    if (orthographic_) return {{u, v, 0}, {0, 0, -1}};
    return {{0, 0, 0}, {u, v, -1}};
  }

 private:
  bool orthographic_;
  double half_height_, half_width_, width_, height_;  // on the plane z = -1
};

}  // namespace kairos
