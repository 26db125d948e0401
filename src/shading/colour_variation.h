// How much what is seen of a triangle may change in colour, looked up: what more than one shading sample is worth.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <kairos/scene.h>

#include "shading/camera_axes.h"

namespace kairos {

/// Of shading by normals: bounds, as distances between unit normals, from 0 to kMost. Immutable.
class ColourVariation {
 public:
  ColourVariation() = default;
  /// O(triangles x keys), in parallel.
  ColourVariation(const Shot& shot, const CameraAxes& world_from_camera);

  /// Was it made without a shot, or with one without meshes?
  bool empty() const { return meshes_.empty(); }

  static constexpr float kMost = 2;

  /// Over the whole triangle and `duration` of shutter time.
  float of(uint32_t mesh, uint32_t triangle, float duration) const {
    const Entry entry = meshes_[mesh][triangle];
    return std::min(kMost,
                    (static_cast<float>(entry.over_area) + static_cast<float>(entry.per_time) * duration) * kUnit);
  }

 private:
  static constexpr float kUnit = 1.0f / 64;
  /// In kUnit, rounded up; of what is too large, the largest.
  struct Entry {
    uint8_t over_area = 0;  ///< at one instant
    uint8_t per_time = 0;   ///< at one point, while the shutter is open, if it went on as it does at its fastest
  };
  static uint8_t to_units(double distance) {
    return static_cast<uint8_t>(std::min(255.0, std::ceil(distance / static_cast<double>(kUnit))));
  }

  std::vector<std::vector<Entry>> meshes_;  // [mesh][triangle]
};

}  // namespace kairos
