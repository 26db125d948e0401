#include "scene_io/pbrt/screen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kairos::pbrt {

namespace {

double largest_stretch(const Mat4& m) {
  double largest = 0;
  for (size_t c = 0; c < 3; ++c) largest = std::max(largest, length(Vec3d{m.m[c][0], m.m[c][1], m.m[c][2]}));
  return largest;
}

}  // namespace

Screen::Screen(const Camera& camera, std::array<int, 2> image_size) : orthographic_(camera.orthographic) {
  const auto [open, close] = camera.shutter;
  times_ = {open, (open + close) / 2, close};
  const AnimatedTransform placed(inverse_affine(camera.camera_from_world.start),
                                 inverse_affine(camera.camera_from_world.end), camera.transform_times);
  for (size_t i = 0; i < times_.size(); ++i) {
    world_from_camera_[i] = placed.at(times_[i], Side::after);
    camera_from_world_[i] = inverse_affine(world_from_camera_[i]);
  }
  // On pbrt's screen the picture's shorter side is 2 long, unless a window says otherwise.
  const double height = camera.screen_window ? (*camera.screen_window)[3] - (*camera.screen_window)[2] : 0;
  unit_ = height > 0 ? image_size[1] / height : std::min(image_size[0], image_size[1]) / 2.0;
  if (!orthographic_) unit_ /= std::tan(camera.fov * std::numbers::pi / 360);
}

double Screen::pixels_per_unit(const TransformPath& world_from_shape, Vec3d center, double radius) const {
  double most = 0;
  for (size_t i = 0; i < times_.size(); ++i) {
    const Mat4 matrix = camera_from_world_[i] * world_from_shape.at(times_[i], Side::after);
    const double stretch = largest_stretch(matrix);
    const double dist = length(transform_point(matrix, center)) - radius * stretch;
    if (!orthographic_ && !(dist > 0)) return std::numeric_limits<double>::infinity();
    most = std::max(most, unit_ * stretch / (orthographic_ ? 1 : dist));
  }
  return most;
}

Vec3d Screen::view(const TransformPath& world_from_shape, Vec3d point) const {
  const Mat4 shape_from_world = inverse_affine(world_from_shape.at(times_[kMiddle], Side::after));
  const Mat4 shape_from_camera = shape_from_world * world_from_camera_[kMiddle];
  if (orthographic_) return transform_vector(shape_from_camera, {0, 0, 1});
  return point - transform_point(shape_from_camera, {});
}

}  // namespace kairos::pbrt
