#include "scene_io/gltf/track.h"

#include <algorithm>
#include <utility>

namespace kairos::gltf {

namespace {

Quaternion quaternion(std::span<const double> v) { return {v[0], v[1], v[2], v[3]}; }

void store(Quaternion q, std::span<double> out) {
  out[0] = q.x;
  out[1] = q.y;
  out[2] = q.z;
  out[3] = q.w;
}

}  // namespace

Track::Track(Interpolation interpolation, bool is_rotation, size_t width, std::vector<double> times,
             std::vector<double> values)
    : interpolation_(interpolation),
      is_rotation_(is_rotation),
      width_(width),
      times_(std::move(times)),
      values_(std::move(values)) {
  if (is_rotation_ && interpolation_ != Interpolation::cubic)  // splines go through the values as they are
    for (size_t i = 0; i + 4 <= values_.size(); i += 4)
      store(normalize(quaternion({&values_[i], 4})), {&values_[i], 4});
  is_constant_ = same_values(0, times_.size() - 1);
}

std::span<const double> Track::value(size_t key) const {
  const size_t slot = interpolation_ == Interpolation::cubic ? key * 3 + 1 : key;
  return {values_.data() + slot * width_, width_};
}
std::span<const double> Track::in_tangent(size_t key) const { return {values_.data() + key * 3 * width_, width_}; }
std::span<const double> Track::out_tangent(size_t key) const {
  return {values_.data() + (key * 3 + 2) * width_, width_};
}

void Track::evaluate(double time, Side side, std::span<double> out) const {
  // Keys that lie at or before `time`, or strictly before it where the limit from the left is wanted.
  const auto next = side == Side::after ? std::upper_bound(times_.begin(), times_.end(), time)
                                        : std::lower_bound(times_.begin(), times_.end(), time);
  const auto passed = static_cast<size_t>(next - times_.begin());
  const bool held = passed == 0 || passed == times_.size();
  const size_t key = passed == 0 ? 0 : passed - 1;
  const auto from = value(key);
  if (held || interpolation_ == Interpolation::step) {
    std::copy(from.begin(), from.end(), out.begin());
  } else {
    const auto to = value(key + 1);
    const double key_span = times_[key + 1] - times_[key], s = (time - times_[key]) / key_span;
    if (interpolation_ == Interpolation::linear) {
      if (is_rotation_)
        store(slerp(quaternion(from), quaternion(to), s), out);
      else
        for (size_t c = 0; c < width_; ++c) out[c] = from[c] * (1 - s) + to[c] * s;
    } else {  // glTF 2.0, Appendix C: cubic Hermite spline
      const auto leaving = out_tangent(key), arriving = in_tangent(key + 1);
      const double s2 = s * s, s3 = s2 * s;
      for (size_t c = 0; c < width_; ++c)
        out[c] = (2 * s3 - 3 * s2 + 1) * from[c] + key_span * (s3 - 2 * s2 + s) * leaving[c] +
                 (3 * s2 - 2 * s3) * to[c] + key_span * (s3 - s2) * arriving[c];
    }
  }
  if (is_rotation_ && interpolation_ == Interpolation::cubic) store(normalize(quaternion(out)), out);
}

bool Track::same_values(size_t first, size_t last) const {
  const auto is_zero = [](std::span<const double> v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return x == 0; });
  };
  for (size_t key = first; key < last; ++key) {
    const auto a = value(key), b = value(key + 1);
    if (!std::equal(a.begin(), a.end(), b.begin())) return false;
    if (interpolation_ == Interpolation::cubic && !(is_zero(out_tangent(key)) && is_zero(in_tangent(key + 1))))
      return false;
  }
  return true;
}

bool Track::is_constant(double open, double close) const {
  if (is_constant_) return true;
  const auto index = [&](auto iterator) { return static_cast<size_t>(iterator - times_.begin()); };
  const size_t passed = index(std::upper_bound(times_.begin(), times_.end(), open));
  const size_t first = passed == 0 ? 0 : passed - 1;
  // The last key whose value has a say: a step's next key only once it is reached.
  size_t last = interpolation_ == Interpolation::step
                    ? index(std::upper_bound(times_.begin(), times_.end(), close))
                    : index(std::lower_bound(times_.begin(), times_.end(), close)) + 1;
  last = std::clamp(last, first + 1, times_.size()) - 1;
  return same_values(first, last);
}

bool Track::is_straight() const {
  return is_piecewise_constant() || (interpolation_ == Interpolation::linear && !is_rotation_);
}

void Track::add_kinks(double open, double close, std::vector<double>& kinks) const {
  if (is_constant_) return;
  const auto first = std::upper_bound(times_.begin(), times_.end(), open);
  const auto last = std::lower_bound(first, times_.end(), close);
  kinks.insert(kinks.end(), first, last);
}

}  // namespace kairos::gltf
