#include "math/transform.h"

#include <gtest/gtest.h>

namespace kairos {
namespace {

TEST(Transform, AMatrixTimesItsInverseIsTheIdentity) {
  const Mat4 a = translation({1, -2, 3}) * rotation(normalize(Quaternion{0.1, 0.7, -0.3, 0.5})) * scaling({2, 0.5, -3});
  const Mat4 product = a * inverse_affine(a);
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r) EXPECT_NEAR(product.m[c][r], c == r ? 1 : 0, 1e-12);
}

TEST(Transform, SlerpTurnsAtConstantSpeed) {
  const Quaternion quarter{0, 0, std::sqrt(0.5), std::sqrt(0.5)};  // 90 degrees about z
  for (double w : {0.0, 0.25, 0.5, 1.0}) {
    const Vec3d p = transform_point(rotation(slerp({}, quarter, w)), {1, 0, 0});
    const double angle = w * std::acos(0.0);
    EXPECT_NEAR(p.x, std::cos(angle), 1e-12);
    EXPECT_NEAR(p.y, std::sin(angle), 1e-12);
  }
}

TEST(Transform, ACameraLooksAlongMinusZAtItsTarget) {
  const Mat4 camera = look_at({1, 2, 3}, {4, 2, 3}, {0, 1, 0});
  const Vec3d ahead = transform_point(camera, {0, 0, -3});
  EXPECT_NEAR(ahead.x, 4, 1e-12);
  EXPECT_NEAR(ahead.y, 2, 1e-12);
  EXPECT_NEAR(ahead.z, 3, 1e-12);
}

}  // namespace
}  // namespace kairos
