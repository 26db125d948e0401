#include "dataset_pose.h"

#include <cmath>

namespace kairos::cli {

using nlohmann::ordered_json;

CameraVelocity velocity_between(const Shot& shot, double from, double to, double axes_at) {
  const auto matrix = camera_matrix(shot, axes_at, CameraAxis::minus_z);
  const auto in_axes = [&](const Vec3d& v) {
    const auto along = [&](size_t axis) { return dot(Vec3d{matrix[0][axis], matrix[1][axis], matrix[2][axis]}, v); };
    return Vec3d{along(0), along(1), along(2)};
  };
  const auto a = camera_pose(shot, from, CameraAxis::minus_z), b = camera_pose(shot, to, CameraAxis::minus_z);
  const double per_time = 1 / (to - from);
  CameraVelocity velocity;
  velocity.linear = in_axes(Vec3d{b[4] - a[4], b[5] - a[5], b[6] - a[6]} * per_time);
  // The rotation from a to b in the world, b times the inverse of a, as a quaternion.
  const Vec3d u{a[1], a[2], a[3]}, v{b[1], b[2], b[3]};
  const double w = a[0] * b[0] + dot(u, v);
  const Vec3d axis = v * a[0] - u * b[0] - cross(v, u);
  const double sine = length(axis);
  if (sine > 0) {
    const double angle = 2 * std::atan2(w < 0 ? -sine : sine, std::abs(w));
    velocity.angular = in_axes(axis * (angle / sine * per_time));
  }
  return velocity;
}

ordered_json intrinsics_of(const Projection& p) {
  ordered_json json{{"width", p.width}, {"height", p.height}};
  if (p.matrix) {
    json["projection_matrix_columns"] = *p.matrix;
  } else if (p.orthographic) {
    json["view_height"] = p.view_height;
    json["pixel_aspect"] = p.pixel_aspect;
  } else if (const auto lens = intrinsics(p)) {
    json["fx"] = lens->fx;
    json["fy"] = lens->fy;
    json["cx"] = lens->cx;
    json["cy"] = lens->cy;
  }
  return json;
}

}  // namespace kairos::cli
