// One animated property over time: an animation sampler of glTF, ready to be evaluated.
#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "scene/motion.h"

namespace kairos::gltf {

enum class Interpolation { step, linear, cubic };

/// Before the first key the first value holds, after the last one the last. Keys with equal times are a jump.
class Track {
 public:
  /// times: ascending seconds, at least one. values: [key][width], or for cubic [key][in-tangent, value,
  /// out-tangent][width]; finite. A rotation has width 4 (x, y, z, w) and is a unit quaternion when evaluated; with
  /// linear interpolation it turns along the shortest arc.
  Track(Interpolation interpolation, bool is_rotation, size_t width, std::vector<double> times,
        std::vector<double> values);

  size_t width() const { return width_; }

  /// out: width() numbers.
  void evaluate(double time, Side side, std::span<double> out) const;

  /// True when the value is the same all along [open, close].
  bool is_constant(double open, double close) const;
  bool is_constant() const { return is_constant_; }

  /// True when the value moves at constant speed, or not at all, between neighbouring keys.
  bool is_straight() const;
  /// True when the value only ever jumps.
  bool is_piecewise_constant() const { return is_constant_ || interpolation_ == Interpolation::step; }

  /// Appends the keys' times inside (open, close).
  void add_kinks(double open, double close, std::vector<double>& kinks) const;

 private:
  std::span<const double> value(size_t key) const;
  std::span<const double> in_tangent(size_t key) const;
  std::span<const double> out_tangent(size_t key) const;
  bool same_values(size_t first, size_t last) const;

  Interpolation interpolation_;
  bool is_rotation_;
  size_t width_;
  std::vector<double> times_, values_;
  bool is_constant_;
};

}  // namespace kairos::gltf
