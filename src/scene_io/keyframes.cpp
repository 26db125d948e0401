#include "scene_io/keyframes.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos {

namespace {

/// Where a time lies among keys: `weight` (0 to 1) of the way from key `a` to key `b`.
struct KeySpan {
  size_t a, b;
  double weight;
};

KeySpan find_key_span(const std::vector<double>& times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {0, 0, 0};
  const auto a = static_cast<size_t>(after - times.begin()) - 1;
  if (after == times.end() || times[a] == time) return {a, a, 0};
  return {a, a + 1, (time - times[a]) / (times[a + 1] - times[a])};
}

/// Do all keys that matter during [open, close] equal the first of them?
template <class Equal>
bool rests(const std::vector<double>& times, double open, double close, const Equal& equal) {
  if (!(open < close)) return true;
  const size_t first = find_key_span(times, open).a, last = find_key_span(times, close).b;
  for (size_t k = first + 1; k <= last; ++k)
    if (!equal(first, k)) return false;
  return true;
}

void add_inside(const std::vector<double>& times, double open, double close, std::vector<double>& out) {
  for (const double time : times)
    if (open < time && time < close) out.push_back(time);
}

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0);
}

bool all_same(const std::vector<std::vector<Vec3f>>& keys) {
  return std::all_of(keys.begin(), keys.end(), [&](const auto& key) { return same_bits(key, keys.front()); });
}

/// a at weight 0, and for all weights where both are equal.
double mix(double a, double b, double weight) { return a + (b - a) * weight; }
Vec3d mix(Vec3d a, Vec3d b, double weight) { return a + (b - a) * weight; }

}  // namespace

Mat4 TransformKeys::at(double time) const {
  if (matrices.empty()) return {};
  const KeySpan span = find_key_span(times, time);
  Mat4 matrix = matrices[span.a];
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r) matrix.m[c][r] = mix(matrix.m[c][r], matrices[span.b].m[c][r], span.weight);
  return matrix;
}

bool TransformKeys::rests(double open, double close) const {
  return kairos::rests(times, open, close, [&](size_t a, size_t b) { return matrices[a] == matrices[b]; });
}

bool TransformKeys::always_rests() const {
  return std::all_of(matrices.begin(), matrices.end(), [&](const Mat4& key) { return key == matrices.front(); });
}

bool TransformKeys::mirrors() const { return !matrices.empty() && determinant3(matrices.front()) < 0; }

KeyframeMotion::KeyframeMotion(std::shared_ptr<const VertexKeys> vertices, TransformKeys transform)
    : vertices_(std::move(vertices)), transform_(std::move(transform)) {
  mirrors_ = transform_.mirrors();
}

bool KeyframeMotion::is_static(double open, double close) const {
  return rests(vertices_->times, open, close,
               [&](size_t a, size_t b) {
                 return same_bits(vertices_->positions[a], vertices_->positions[b]) &&
                        (vertices_->normals.empty() || same_bits(vertices_->normals[a], vertices_->normals[b]));
               }) &&
         transform_.rests(open, close);
}

bool KeyframeMotion::is_linear_between_kinks() const {
  return transform_.always_rests() || all_same(vertices_->positions);
}

std::vector<double> KeyframeMotion::kinks(double open, double close) const {
  std::vector<double> times;
  add_inside(vertices_->times, open, close, times);
  add_inside(transform_.times, open, close, times);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

void KeyframeMotion::positions(double time, Side, std::span<Vec3d> out) const {
  const KeySpan span = find_key_span(vertices_->times, time);
  const auto &a = vertices_->positions[span.a], &b = vertices_->positions[span.b];
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = span.a == span.b ? to_double(a[v]) : mix(to_double(a[v]), to_double(b[v]), span.weight);
  if (transform_.matrices.empty()) return;
  const Mat4 matrix = transform_.at(time);
  for (Vec3d& p : out) p = transform_point(matrix, p);
}

void KeyframeMotion::normals(double time, Side, std::span<Vec3f> out) const {
  const KeySpan span = find_key_span(vertices_->times, time);
  const auto &a = vertices_->normals[span.a], &b = vertices_->normals[span.b];
  const Mat4 matrix = normal_matrix(transform_.at(time));
  const double sign = mirrors_ ? -1 : 1;
  const bool plain = span.a == span.b && transform_.matrices.empty();  // unit already: keep the file's bits
  for (size_t v = 0; v < out.size(); ++v)
    out[v] =
        plain
            ? a[v]
            : to_float(normalize(transform_vector(matrix, mix(to_double(a[v]), to_double(b[v]), span.weight)) * sign));
}

std::shared_ptr<const VertexShape> KeyframeMotion::shape() const {
  if (vertices_->positions.size() != 1) return nullptr;
  VertexShape shape{vertices_->positions.front(), {}, {}};
  if (has_normals()) shape.normals = vertices_->normals.front();
  return std::make_shared<const VertexShape>(shape);
}

Mat4 KeyframeMotion::placement(double time, Side) const { return transform_.at(time); }

namespace {

/// Throws when between two keys direction and up become parallel, or one of them zero: where all components of their
/// cross product, quadratics in time, vanish together.
void check_directions(const LookAtKey& a, const LookAtKey& b, const std::string& place) {
  // Relative to the longest vectors involved; far above rounding, far below what anyone would call a direction.
  constexpr double kParallel = 1e-12;
  const Vec3d dir_a = a.target - a.eye, dir_b = b.target - b.eye;
  const auto side = [&](double weight) { return cross(mix(dir_a, dir_b, weight), mix(a.up, b.up, weight)); };
  const double scale = std::max(length(dir_a), length(dir_b)) * std::max(length(a.up), length(b.up));
  // side(w) = c0 + c1 w + c2 w^2. A common zero of its components is a root of each that is not zero throughout.
  const Vec3d c0 = side(0), c2 = (side(1) + c0 - side(0.5) * 2.0) * 2.0, c1 = side(1) - c0 - c2;
  std::vector<double> weights{0, 1};
  for (int axis = 0; axis < 3; ++axis) {
    const double qa = c2[axis], qb = c1[axis], qc = c0[axis];
    const double root = std::sqrt(std::max(0.0, qb * qb - 4 * qa * qc));
    const double q = -(qb + std::copysign(root, qb)) / 2;
    if (qa != 0) weights.push_back(q / qa);
    if (q != 0) weights.push_back(qc / q);
  }
  for (const double weight : weights)
    if (weight >= 0 && weight <= 1 && !(length(side(weight)) > kParallel * scale))
      throw Error(ErrorCode::bad_input, place,
                  fmt::format("at time {} the camera has no direction: eye and target meet, or up is along the view",
                              mix(a.time, b.time, weight)));
}

}  // namespace

LookAtMotion::LookAtMotion(std::vector<LookAtKey> keys, const std::string& place) : keys_(std::move(keys)) {
  for (size_t k = 0; k < keys_.size(); ++k) {
    times_.push_back(keys_[k].time);
    check_directions(keys_[k], keys_[std::min(k + 1, keys_.size() - 1)], place);
  }
}

bool LookAtMotion::is_static(double open, double close) const {
  return rests(times_, open, close, [&](size_t a, size_t b) {
    return keys_[a].eye == keys_[b].eye && keys_[a].target == keys_[b].target && keys_[a].up == keys_[b].up;
  });
}

std::vector<double> LookAtMotion::kinks(double open, double close) const {
  std::vector<double> times;
  add_inside(times_, open, close, times);
  return times;
}

Mat4 LookAtMotion::at(double time, Side) const {
  const KeySpan span = find_key_span(times_, time);
  const LookAtKey &a = keys_[span.a], &b = keys_[span.b];
  return look_at(mix(a.eye, b.eye, span.weight), mix(a.target, b.target, span.weight), mix(a.up, b.up, span.weight));
}

}  // namespace kairos
