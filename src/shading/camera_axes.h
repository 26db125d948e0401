// How the camera is turned at any instant, looked up rather than computed anew for every shading sample.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <kairos/scene.h>

namespace kairos {

class CameraAxes {
 public:
  explicit CameraAxes(const Shot& shot);

  /// The axes of the shot's space in the world at a shutter time in [0, 1], as Shot::world_from_camera gives them. Of a
  /// camera that turns: within kError of it in each component, except near jumps, which take 1 / kMostSteps of the
  /// shutter.
  std::array<Vec3d, 3> at(float time) const {
    if (table_.size() == 1) return table_[0];
    const double place = static_cast<double>(time) * static_cast<double>(table_.size() - 1);
    const size_t below = std::min(static_cast<size_t>(place), table_.size() - 2);
    const double weight = place - static_cast<double>(below);
    std::array<Vec3d, 3> axes;
    for (size_t k = 0; k < 3; ++k) axes[k] = lerp(table_[below][k], table_[below + 1][k], weight);
    return axes;
  }

  static constexpr double kError = 1e-6;
  static constexpr size_t kMostSteps = 16384;

 private:
  std::vector<std::array<Vec3d, 3>> table_;  // at evenly spaced times from 0 to 1; one for a camera that stands still
};

}  // namespace kairos
