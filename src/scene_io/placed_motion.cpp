#include "scene_io/placed_motion.h"

#include <algorithm>
#include <iterator>

namespace kairos {

PlacedMotion::PlacedMotion(std::shared_ptr<const VertexMotion> inner, TransformKeys transform)
    : inner_(std::move(inner)), transform_(std::move(transform)) {}

bool PlacedMotion::is_static(double open, double close) const {
  return transform_.rests(open, close) && inner_->is_static(open, close);
}

bool PlacedMotion::is_linear_between_kinks() const {
  return transform_.always_rests() && inner_->is_linear_between_kinks();
}

std::vector<double> PlacedMotion::kinks(double open, double close) const {
  const std::vector<double> inner = inner_->kinks(open, close);
  std::vector<double> own, times;
  for (const double time : transform_.times)
    if (open < time && time < close) own.push_back(time);
  std::set_union(inner.begin(), inner.end(), own.begin(), own.end(), std::back_inserter(times));
  return times;
}

void PlacedMotion::positions(double time, Side side, std::span<Vec3d> out) const {
  inner_->positions(time, side, out);
  const Mat4 matrix = transform_.at(time);
  for (Vec3d& p : out) p = transform_point(matrix, p);
}

void PlacedMotion::normals(double time, Side side, std::span<Vec3f> out) const {
  inner_->normals(time, side, out);
  const Mat4 matrix = normal_matrix(transform_.at(time));
  const double sign = transform_.mirrors() ? -1 : 1;
  for (Vec3f& n : out) n = to_float(normalize(transform_vector(matrix, to_double(n)) * sign));
}

void PlacedMotion::tangents(double time, Side side, std::span<Vec4f> out) const {
  inner_->tangents(time, side, out);
  const Mat4 matrix = transform_.at(time);
  const float sign = transform_.mirrors() ? -1 : 1;  // what lies across is seen mirrored, and the normal is turned
  for (Vec4f& tangent : out) {
    const Vec3d along{tangent.x, tangent.y, tangent.z};
    const Vec3f placed = to_float(normalize(transform_vector(matrix, along)));
    tangent = {placed.x, placed.y, placed.z, tangent.w * sign};
  }
}

Mat4 PlacedMotion::placement(double time, Side side) const {
  return transform_.at(time) * inner_->placement(time, side);
}

}  // namespace kairos
