// How wide a piece of the scene a pixel sees.
#pragma once

#include <cmath>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "camera/film_plane.h"

namespace kairos {

class PixelCone {
 public:
  explicit PixelCone(const Projection& projection) {
    const FilmPlane plane(projection);
    (plane.orthographic() ? start_ : spread_) = plane.pixel_side();
  }

  /// Across the ray at `point` on it, in scene units. The ray's direction is as long as CameraRays makes it.
  double width_at(Vec3d point, const Ray& ray) const {
    const Vec3d direction = to_double(ray.direction);
    return start_ + spread_ * std::abs(dot(point - to_double(ray.origin), direction)) / dot(direction, direction);
  }

  /// The same `dist` along the ray, in lengths of its direction.
  double width_at(float dist) const { return start_ + spread_ * static_cast<double>(dist); }

  /// By how much the width grows along a unit of length, of rays near the view axis.
  double spread() const { return spread_; }

 private:
  double start_ = 0, spread_ = 0;
};

}  // namespace kairos
