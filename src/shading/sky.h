// Light from infinitely far away that pictures give.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <kairos/scene.h>

namespace kairos {

class Texture;

/// All of a shot's environment lights that have a picture. Directions are unit and in world space. Safe to use from
/// many threads at once.
class Sky {
 public:
  /// is_light: sample() and density() will be asked for; what they need takes time to make.
  explicit Sky(const Shot& shot, bool is_light = true);
  ~Sky();

  bool empty() const { return pictures_.empty(); }

  /// From one direction. width: radians to average over; 0 for the picture as it is.
  Vec3f radiance(Vec3d direction, double width = 0) const;

  /// A direction, about as likely as it is bright. sample: uniform in [0, 1)^3. Nothing where all is black.
  std::optional<Vec3d> sample(const std::array<float, 3>& sample) const;
  /// How likely sample() is to give the direction, per steradian.
  double density(Vec3d direction) const;

 private:
  class Picture;
  std::vector<Picture> pictures_;
  double power_ = 0;  // of all pictures, in units of sample()'s weights
};

}  // namespace kairos
