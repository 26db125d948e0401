#include "scene/view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kairos/error.h>

#include "camera/film_plane.h"

namespace kairos {

namespace {
// Eight roundings of a float just below 1: nearer key times could coincide once they are floats.
constexpr double kSameTime = 5e-7;
// Instants per stretch at which a camera that may move is looked at, to see whether it does. Not a divisor of a turn.
constexpr int kCameraProbes = 7;

std::array<Vec3d, 3> rotation_columns(const Mat4& m) {
  std::array<Vec3d, 3> columns;
  for (size_t c = 0; c < 3; ++c) columns[c] = normalize(Vec3d{m.m[c][0], m.m[c][1], m.m[c][2]});
  return columns;
}

/// Equal but for the roundings of a few interpolations in double precision.
bool nearly_equal(const Mat4& a, const Mat4& b) {
  constexpr double kRoundings = 1e-13;
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r)
      if (std::abs(a.m[c][r] - b.m[c][r]) > kRoundings * (1 + std::abs(a.m[c][r]))) return false;
  return true;
}
}  // namespace

std::vector<double> merge_kinks(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> merged(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), merged.begin());
  merged.erase(std::unique(merged.begin(), merged.end()), merged.end());
  return merged;
}

std::vector<Stretch> divide_at_kinks(const ShutterWindow& window, const std::vector<double>& kinks) {
  std::vector<Stretch> stretches{{window.open, window.close, 0, 1}};
  for (double kink : kinks) {
    const double time = window.shutter_time(kink);
    if (!(time > 0 && time < 1)) continue;
    Stretch& current = stretches.back();
    if (time - current.time_begin < kSameTime) {  // joins the kink, or the opening, that this stretch begins with
      current.begin = kink;
    } else if (1 - time < kSameTime) {  // joins the end
      current.end = kink;
      break;
    } else {
      current.end = kink;
      current.time_end = time;
      stretches.push_back({kink, window.close, time, 1});
    }
  }
  return stretches;
}

View::View(const SceneCamera& camera, const Projection& projection, ShotOptions::Space space,
           const ShutterWindow& window)
    : name_(camera.name), motion_(camera.motion), space_(space), window_(window) {
  const FilmPlane plane(projection);
  orthographic_ = plane.orthographic();
  pixels_per_unit_ = plane.pixels_per_unit();
  obliquity_limit_ = 1 + plane.farthest_corner();

  resting_ = camera_from_world(window.open, Side::after);
  if (window.holds_still(*motion_)) return;
  for (const Stretch& s : divide_at_kinks(window, motion_->kinks(window.open, window.close))) {
    for (int i = 0; i <= kCameraProbes; ++i) {
      const double weight = static_cast<double>(i) / kCameraProbes;
      const Mat4 m = camera_from_world(s.begin * (1 - weight) + s.end * weight, i ? Side::before : Side::after);
      camera_moves_ |= !nearly_equal(m, resting_);
    }
  }
}

Mat4 View::camera_from_world(double scene_time, Side side) const {
  const Mat4 inverse = inverse_affine(motion_->at(scene_time, side));
  for (const auto& column : inverse.m)
    for (double x : column)
      if (!std::isfinite(x))
        throw Error(ErrorCode::bad_input, "camera '" + name_ + "'",
                    "its placement at time " + std::to_string(scene_time) + " is singular or not finite");
  return inverse;
}

std::vector<double> View::space_kinks() const {
  return space_moves() ? motion_->kinks(window_.open, window_.close) : std::vector<double>{};
}

Mat4 View::space_from_world(double scene_time, Side side) const {
  if (space_ == ShotOptions::Space::world) return {};
  return camera_moves_ ? camera_from_world(scene_time, side) : resting_;
}

Mat4 View::camera_from_space(double scene_time, Side side) const {
  if (space_ == ShotOptions::Space::camera) return {};
  return camera_moves_ ? camera_from_world(scene_time, side) : resting_;
}

double View::screen_distance(Vec3d truth, Vec3d approximation, double near_dist) const {
  const Vec3d error = approximation - truth;
  if (orthographic_) return std::hypot(error.x, error.y) * pixels_per_unit_;

  const double dist_squared = dot(truth, truth);
  const double depth = -truth.z;
  const double obliquity = depth > 0 ? std::min(dist_squared / (depth * depth), obliquity_limit_) : obliquity_limit_;
  const double scale = pixels_per_unit_ * obliquity;
  if (dist_squared < near_dist * near_dist) return length(error) / near_dist * scale;
  // The tangent of the angle between the two view rays; the cross product with the error keeps its small digits.
  const double along = dot(truth, approximation);
  if (along <= 0) return std::numeric_limits<double>::infinity();
  return length(cross(truth, error)) / along * scale;
}

std::function<std::array<Vec3d, 3>(double)> View::world_from_camera() const {
  const std::array<Vec3d, 3> resting = rotation_columns(inverse_affine(resting_));
  if (space_ == ShotOptions::Space::world)
    return [](double) { return std::array<Vec3d, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; };
  if (!camera_moves_) return [resting](double) { return resting; };
  return [motion = motion_, window = window_](double time) {
    return rotation_columns(motion->at(window.scene_time(time), time < 1 ? Side::after : Side::before));
  };
}

std::function<Vec3d(double)> View::camera_position() const {
  if (space_ == ShotOptions::Space::world) return [](double) { return Vec3d{}; };
  const auto origin = [](const Mat4& world_from_camera) { return transform_point(world_from_camera, {0, 0, 0}); };
  if (!camera_moves_) return [resting = origin(inverse_affine(resting_))](double) { return resting; };
  return [motion = motion_, window = window_, origin](double time) {
    return origin(motion->at(window.scene_time(time), time < 1 ? Side::after : Side::before));
  };
}

}  // namespace kairos
