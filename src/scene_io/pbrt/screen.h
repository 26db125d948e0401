// How large things are on the picture that a pbrt file's own camera and film describe.
#pragma once

#include <array>

#include "scene_io/pbrt/camera.h"
#include "scene_io/pbrt/motion.h"

namespace kairos::pbrt {

class Screen {
 public:
  Screen(const Camera& camera, std::array<int, 2> image_size);

  /// How many pixels a unit of length covers at most anywhere in a ball of the shape's own space, while the shutter is
  /// open; whether the ball is in the picture does not matter: mirrors may show it. Infinite where the eye is in the
  /// ball.
  double pixels_per_unit(const TransformPath& world_from_shape, Vec3d center, double radius) const;

  /// From the eye to a point of the shape's own space, in that space, when the shutter is half open. Any length.
  Vec3d view(const TransformPath& world_from_shape, Vec3d point) const;

 private:
  static constexpr size_t kMiddle = 1;
  std::array<double, 3> times_;  ///< the shutter opens, is half open, closes
  std::array<Mat4, 3> camera_from_world_, world_from_camera_;
  bool orthographic_;
  double unit_;  ///< pixels of a unit of length at distance 1, or at any, in the camera's own units
};

}  // namespace kairos::pbrt
