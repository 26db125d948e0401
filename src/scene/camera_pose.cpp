#include <algorithm>
#include <cmath>

#include <kairos/camera_pose.h>

namespace kairos {

namespace {

double shutter_time(const Shot& shot, double scene_time) {
  const double length = shot.shutter_close - shot.shutter_open;
  return length > 0 ? std::clamp((scene_time - shot.shutter_open) / length, 0.0, 1.0) : 0;
}

std::array<Vec3d, 3> axes_of(const Shot& shot, double scene_time, CameraAxis axis) {
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  if (shot.world_from_camera) axes = shot.world_from_camera(shutter_time(shot, scene_time));
  if (axis == CameraAxis::plus_z)
    for (const size_t i : {size_t{1}, size_t{2}}) axes[i] = Vec3d{} - axes[i];
  return axes;
}

Vec3d place_of(const Shot& shot, double scene_time) {
  return shot.camera_position ? shot.camera_position(shutter_time(shot, scene_time)) : Vec3d{};
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

std::array<double, 7> camera_pose(const Shot& shot, double scene_time, CameraAxis axis) {
  const std::array<double, 4> q = quaternion_of(axes_of(shot, scene_time, axis));
  const Vec3d place = place_of(shot, scene_time);
  return {q[0], q[1], q[2], q[3], place.x, place.y, place.z};
}

std::array<std::array<double, 4>, 4> camera_matrix(const Shot& shot, double scene_time, CameraAxis axis) {
  const std::array<Vec3d, 3> a = axes_of(shot, scene_time, axis);
  const Vec3d place = place_of(shot, scene_time);
  return {{{a[0].x, a[1].x, a[2].x, place.x},
           {a[0].y, a[1].y, a[2].y, place.y},
           {a[0].z, a[1].z, a[2].z, place.z},
           {0, 0, 0, 1}}};
}

std::optional<Intrinsics> intrinsics(const Projection& p) {
  if (p.matrix || p.orthographic) return std::nullopt;
  const double focal = p.height / 2.0 / std::tan(p.vfov / 2);
  return Intrinsics{focal / p.pixel_aspect, focal, p.width / 2.0 - p.shift[0] * p.height / p.pixel_aspect,
                    p.height / 2.0 + p.shift[1] * p.height};
}

}  // namespace kairos
