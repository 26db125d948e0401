// Film points to rays in camera space.
#pragma once

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "camera/film_plane.h"

namespace kairos {

/// Rays have a direction of (x, y, -1), so that their `dist` is the distance along the view axis.
class CameraRays {
 public:
  explicit CameraRays(const Projection& projection) : plane_(projection) {}

  /// x, y: pixels from the frame's upper left corner.
  Ray at(double x, double y) const {
    const Vec2d point = plane_.at(x, y);
    const auto u = static_cast<float>(point.x), v = static_cast<float>(point.y);
    if (plane_.orthographic()) return {{u, v, 0}, {0, 0, -1}};
    return {{0, 0, 0}, {u, v, -1}};
  }

 private:
  FilmPlane plane_;
};

}  // namespace kairos
