#include "scene_io/pbrt/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kairos::pbrt {

namespace {

/// The unit quaternion of a proper rotation matrix.
Quaternion quaternion_of(const Mat4& matrix) {
  const auto& m = matrix.m;  // [column][row]
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    const double s = std::sqrt(trace + 1) * 2;
    return normalize(Quaternion{(m[1][2] - m[2][1]) / s, (m[2][0] - m[0][2]) / s, (m[0][1] - m[1][0]) / s, s / 4});
  }
  // The largest component is found first, so that nothing is divided by a small number.
  const size_t i = m[0][0] >= m[1][1] && m[0][0] >= m[2][2] ? 0 : m[1][1] >= m[2][2] ? 1 : 2;
  const size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = std::sqrt(std::max(0.0, 1 + m[i][i] - m[j][j] - m[k][k])) * 2;
  double q[3];
  q[i] = s / 4;
  q[j] = (m[i][j] + m[j][i]) / s;
  q[k] = (m[i][k] + m[k][i]) / s;
  return normalize(Quaternion{q[0], q[1], q[2], (m[j][k] - m[k][j]) / s});
}

Mat4 scaled3(Mat4 a, double factor) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t r = 0; r < 3; ++r) a.m[c][r] *= factor;
  return a;
}

Mat4 transposed3(const Mat4& a) {
  Mat4 b;
  for (size_t c = 0; c < 3; ++c)
    for (size_t r = 0; r < 3; ++r) b.m[c][r] = a.m[r][c];
  return b;
}

Mat4 mix(const Mat4& a, const Mat4& b, double weight) {
  Mat4 result;
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r) result.m[c][r] = a.m[c][r] + (b.m[c][r] - a.m[c][r]) * weight;
  return result;
}

}  // namespace

Decomposed::Decomposed(const Mat4& matrix) : translation{matrix.m[3][0], matrix.m[3][1], matrix.m[3][2]} {
  Mat4 linear = matrix;
  linear.m[3] = {0, 0, 0, 1};
  // Newton's iteration to the nearest orthogonal matrix: quadratic at the end, but a stretch far from 1 is only halved
  // at each step.
  constexpr int kMaxSteps = 200;
  constexpr double kConverged = 1e-15;
  Mat4 orthogonal = linear;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Mat4 next = mix(orthogonal, transposed3(inverse_affine(orthogonal)), 0.5);
    double change = 0;
    for (size_t c = 0; c < 3; ++c)
      for (size_t r = 0; r < 3; ++r) change = std::max(change, std::abs(next.m[c][r] - orthogonal.m[c][r]));
    orthogonal = next;
    if (!(change > kConverged)) break;
  }
  if (determinant3(orthogonal) < 0) orthogonal = scaled3(orthogonal, -1);
  rotation = quaternion_of(orthogonal);
  stretch = transposed3(kairos::rotation(rotation)) * linear;
}

AnimatedTransform::AnimatedTransform(const Mat4& start, const Mat4& end, std::array<double, 2> times)
    : start_(start), end_(end), times_(times) {
  if (start == end) return;
  const auto parts = std::make_shared<const std::array<Decomposed, 2>>(std::array{Decomposed(start), Decomposed(end)});
  const Quaternion a = (*parts)[0].rotation, b = (*parts)[1].rotation;
  // A turn by less moves a point by less than float's rounding of its place.
  constexpr double kSameRotation = 1e-14;
  same_rotation_ = 1 - std::abs(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w) < kSameRotation;
  parts_ = parts;
}

bool AnimatedTransform::is_static(double open, double close) const {
  return !moves() || close <= times_[0] || open >= times_[1];
}

void AnimatedTransform::add_kinks(double open, double close, std::vector<double>& kinks) const {
  if (!moves()) return;
  for (const double time : times_)
    if (open < time && time < close) kinks.push_back(time);
}

Mat4 AnimatedTransform::at(double time, Side side) const {
  const bool jumps = times_[0] == times_[1];
  if (!moves() || time < times_[0] || (time == times_[0] && (!jumps || side == Side::before))) return start_;
  if (time >= times_[1]) return end_;
  const double weight = (time - times_[0]) / (times_[1] - times_[0]);
  const Decomposed &a = (*parts_)[0], &b = (*parts_)[1];
  return translation(a.translation + (b.translation - a.translation) * weight) *
         rotation(slerp(a.rotation, b.rotation, weight)) * mix(a.stretch, b.stretch, weight);
}

TransformPath TransformPath::then(const TransformPath& inner) const {
  TransformPath result = *this;
  for (const AnimatedTransform& step : inner.steps_) {
    if (!result.steps_.empty() && !result.steps_.back().moves() && !step.moves())
      result.steps_.back() = AnimatedTransform(result.steps_.back().start() * step.start());
    else
      result.steps_.push_back(step);
  }
  return result;
}

bool TransformPath::is_static(double open, double close) const {
  return std::all_of(steps_.begin(), steps_.end(), [&](const auto& step) { return step.is_static(open, close); });
}

bool TransformPath::is_linear() const {
  // The product of two that move is not linear, even where each of them is.
  const auto moving = std::count_if(steps_.begin(), steps_.end(), [](const auto& step) { return step.moves(); });
  return moving <= 1 && std::all_of(steps_.begin(), steps_.end(), [](const auto& step) { return step.is_linear(); });
}

std::vector<double> TransformPath::kinks(double open, double close) const {
  std::vector<double> times;
  for (const AnimatedTransform& step : steps_) step.add_kinks(open, close, times);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

Mat4 TransformPath::at(double time, Side side) const {
  if (steps_.empty()) return {};
  Mat4 matrix = steps_.front().at(time, side);
  for (size_t i = 1; i < steps_.size(); ++i) matrix = matrix * steps_[i].at(time, side);
  return matrix;
}

InstanceMotion::InstanceMotion(std::shared_ptr<const Vertices> vertices, TransformPath path, bool reversed)
    : vertices_(std::move(vertices)), path_(std::move(path)), reversed_(reversed) {
  mirrors_ = determinant3(path_.at(-std::numeric_limits<double>::infinity(), Side::before)) < 0;
}

void InstanceMotion::positions(double time, Side side, std::span<Vec3d> out) const {
  const Mat4 matrix = path_.at(time, side);
  for (size_t v = 0; v < out.size(); ++v) out[v] = transform_point(matrix, to_double(vertices_->positions[v]));
}

void InstanceMotion::normals(double time, Side side, std::span<Vec3f> out) const {
  const Mat4 matrix = normal_matrix(path_.at(time, side));
  const double sign = mirrors_ != reversed_ ? -1 : 1;
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = to_float(normalize(transform_vector(matrix, to_double(vertices_->normals[v]) * sign)));
}

Mat4 CameraMotion::at(double time, Side side) const {
  const Mat4 world = path_.at(time, side);
  const auto column = [&](size_t c) { return Vec3d{world.m[c][0], world.m[c][1], world.m[c][2]}; };
  Mat4 placed = look_at({}, normalize(column(2)), column(1));
  placed.m[3] = world.m[3];
  return placed;
}

}  // namespace kairos::pbrt
