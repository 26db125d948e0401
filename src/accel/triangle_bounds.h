#pragma once

#include <algorithm>
#include <array>

#include <kairos/scene.h>

#include "accel/box_lanes.h"

namespace kairos {

/// Bounds of a triangle at one key: smallest coordinates, and the largest negated.
inline std::array<Lanes, 2> bounds_at(const Mesh& mesh, const Triangle& triangle, size_t key) {
  const Vec3f* positions = mesh.positions[key].data();
  const Vec3f a = positions[triangle[0]], b = positions[triangle[1]], c = positions[triangle[2]];
  std::array<Lanes, 2> bounds{};
  for (int axis = 0; axis < 3; ++axis) {
    bounds[0][axis] = std::min(std::min(a[axis], b[axis]), c[axis]);
    bounds[1][axis] = -std::max(std::max(a[axis], b[axis]), c[axis]);
  }
  return bounds;
}

}  // namespace kairos
