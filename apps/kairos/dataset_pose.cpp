#include "dataset_pose.h"

#include <algorithm>
#include <cmath>

namespace kairos::cli {

namespace {

using nlohmann::ordered_json;

double shutter_time(const Shot& shot, double scene_time) {
  const double length = shot.shutter_close - shot.shutter_open;
  return length > 0 ? std::clamp((scene_time - shot.shutter_open) / length, 0.0, 1.0) : 0;
}

std::array<Vec3d, 3> axes_at_time(const Shot& shot, double scene_time) {
  if (!shot.world_from_camera) return {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  return shot.world_from_camera(shutter_time(shot, scene_time));
}

Vec3d in_axes(const std::array<Vec3d, 3>& axes, const Vec3d& v) {
  return {dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)};
}

/// Of a camera whose axes in the world are these: w, x, y, z.
std::array<double, 4> quaternion_of(const std::array<Vec3d, 3>& a) {
  // The largest component first, which is at least 1/2: nothing is divided by what may be 0.
  const double w = 1 + a[0].x + a[1].y + a[2].z, x = 1 + a[0].x - a[1].y - a[2].z, y = 1 - a[0].x + a[1].y - a[2].z,
               z = 1 - a[0].x - a[1].y + a[2].z;
  const double most = std::max({w, x, y, z}), s = 0.5 / std::sqrt(most);
  if (most == w) return {w * s, (a[1].z - a[2].y) * s, (a[2].x - a[0].z) * s, (a[0].y - a[1].x) * s};
  if (most == x) return {(a[1].z - a[2].y) * s, x * s, (a[0].y + a[1].x) * s, (a[2].x + a[0].z) * s};
  if (most == y) return {(a[2].x - a[0].z) * s, (a[0].y + a[1].x) * s, y * s, (a[1].z + a[2].y) * s};
  return {(a[0].y - a[1].x) * s, (a[2].x + a[0].z) * s, (a[1].z + a[2].y) * s, z * s};
}

}  // namespace

std::array<double, 7> pose_at(const Shot& shot, double scene_time) {
  const double time = shutter_time(shot, scene_time);
  std::array<double, 4> q{1, 0, 0, 0};
  Vec3d place;
  if (shot.world_from_camera) q = quaternion_of(shot.world_from_camera(time));
  if (shot.camera_position) place = shot.camera_position(time);
  return {q[0], q[1], q[2], q[3], place.x, place.y, place.z};
}

ordered_json pose_matrix(const Shot& shot, double scene_time) {
  const auto axes = axes_at_time(shot, scene_time);
  const auto pose = pose_at(shot, scene_time);
  ordered_json rows = ordered_json::array();
  rows.push_back({axes[0].x, axes[1].x, axes[2].x, pose[4]});
  rows.push_back({axes[0].y, axes[1].y, axes[2].y, pose[5]});
  rows.push_back({axes[0].z, axes[1].z, axes[2].z, pose[6]});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

CameraVelocity velocity_between(const Shot& shot, double from, double to, double axes_at) {
  const auto axes = axes_at_time(shot, axes_at);
  const auto a = pose_at(shot, from), b = pose_at(shot, to);
  const double per_time = 1 / (to - from);
  CameraVelocity velocity;
  velocity.linear = in_axes(axes, Vec3d{b[4] - a[4], b[5] - a[5], b[6] - a[6]} * per_time);
  // The rotation from a to b in the world, b times the inverse of a, as a quaternion.
  const Vec3d u{a[1], a[2], a[3]}, v{b[1], b[2], b[3]};
  const double w = a[0] * b[0] + dot(u, v);
  const Vec3d axis = v * a[0] - u * b[0] - cross(v, u);
  const double sine = length(axis);
  if (sine > 0) {
    const double angle = 2 * std::atan2(w < 0 ? -sine : sine, std::abs(w));
    velocity.angular = in_axes(axes, axis * (angle / sine * per_time));
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
  } else {
    const double focal = p.height / 2.0 / std::tan(p.vfov / 2);  // pixels
    json["fx"] = focal / p.pixel_aspect;
    json["fy"] = focal;
    json["cx"] = p.width / 2.0 - p.shift[0] * p.height / p.pixel_aspect;
    json["cy"] = p.height / 2.0 + p.shift[1] * p.height;
  }
  return json;
}

}  // namespace kairos::cli
