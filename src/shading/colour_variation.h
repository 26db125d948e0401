// How much what is seen of a triangle may change in colour, looked up: what more than one shading sample is worth.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include <kairos/scene.h>

#include "shading/camera_axes.h"

namespace kairos {

/// Of shading by normals: bounds, as distances between unit normals, from 0 to kMost. They are found when they are
/// first asked for, since most triangles of a large scene are never seen; any thread may ask.
class ColourVariation {
 public:
  ColourVariation() = default;
  /// The shot outlives this.
  ColourVariation(const Shot& shot, const CameraAxes& world_from_camera);

  /// Was it made without a shot, or with one without meshes?
  bool empty() const { return known_.empty(); }

  static constexpr float kMost = 2;

  /// Over the whole triangle and `duration` of shutter time.
  float of(uint32_t mesh, uint32_t triangle, float duration) const {
    uint16_t entry = known_[mesh][triangle].load(std::memory_order_relaxed);
    if (entry == kUnknown) {  // who else finds it finds the same
      entry = find(mesh, triangle);
      known_[mesh][triangle].store(entry, std::memory_order_relaxed);
    }
    const auto over_area = static_cast<float>((entry >> 8) - 1), per_time = static_cast<float>(entry & 0xff);
    return std::min(kMost, (over_area + per_time * duration) * kUnit);
  }

 private:
  /// A key, or an instant between two.
  struct Instant {
    size_t key, next;
    double weight;
    double duration;            // since the one before
    std::array<Vec3d, 3> axes;  // of the shot's space in the world
  };

  static constexpr float kUnit = 1.0f / 64;
  static constexpr uint16_t kUnknown = 0;

  /// Two numbers in kUnit, rounded up. Upper byte: one more than over the area at one instant, at most kMost. Lower
  /// byte: at one point while the shutter is open, if it went on as it does at its fastest; of what is too large, the
  /// largest.
  uint16_t find(uint32_t mesh, uint32_t triangle) const;
  static std::array<Vec3d, 3> corner_normals(const Mesh& mesh, const Triangle& triangle, const Instant& at);

  const std::vector<Mesh>* meshes_ = nullptr;
  std::vector<std::vector<Instant>> instants_;                     // [set of key times]
  std::vector<uint32_t> set_of_;                                   // [mesh]
  mutable std::vector<std::vector<std::atomic<uint16_t>>> known_;  // [mesh][triangle]
};

}  // namespace kairos
