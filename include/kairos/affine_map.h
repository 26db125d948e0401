// Where an instance's object lies.
#pragma once

#include <array>
#include <cstddef>

#include <kairos/vec.h>

namespace kairos {

/// An affine map in single precision. All that places an instance computes points in this very order of operations: so
/// the kernels, shading and an expanded copy agree to the last bit, and as rounding keeps order, no vertex leaves a box
/// whose bounds are mapped the same way.
struct AffineMap {
  std::array<Vec4f, 3> rows{Vec4f{1, 0, 0, 0}, Vec4f{0, 1, 0, 0}, Vec4f{0, 0, 1, 0}};  ///< w: the translation

  Vec3f point(Vec3f p) const { return {along(0, p), along(1, p), along(2, p)}; }
  friend bool operator==(const AffineMap&, const AffineMap&) = default;

 private:
  float along(size_t axis, Vec3f p) const {
    const Vec4f& row = rows[axis];
    return ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  }
};

}  // namespace kairos
