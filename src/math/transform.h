// Affine and projective 4x4 matrices in double precision, column-major as in glTF: m[column][row].
#pragma once

#include <array>

#include <kairos/vec.h>

namespace kairos {

struct Mat4 {
  std::array<std::array<double, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  friend bool operator==(const Mat4&, const Mat4&) = default;
};

Mat4 operator*(const Mat4& a, const Mat4& b);

/// Ignores the last row: meant for affine matrices.
inline Vec3d transform_point(const Mat4& a, Vec3d p) {
  const auto& m = a.m;
  return {m[0][0] * p.x + m[1][0] * p.y + m[2][0] * p.z + m[3][0],
          m[0][1] * p.x + m[1][1] * p.y + m[2][1] * p.z + m[3][1],
          m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z + m[3][2]};
}
inline Vec3d transform_vector(const Mat4& a, Vec3d v) {
  const auto& m = a.m;
  return {m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z, m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z,
          m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z};
}
/// Determinant of the upper left 3x3.
double determinant3(const Mat4& a);
/// The matrix that takes normals along: the upper 3x3's cofactors. Not normalised; right for mirrored and singular `a`
/// too.
Mat4 normal_matrix(const Mat4& a);
/// Inverse of an affine matrix. A singular one gives a matrix that is not finite.
Mat4 inverse_affine(const Mat4& a);

Mat4 translation(Vec3d t);
Mat4 scaling(Vec3d s);

/// Unit quaternion x i + y j + z k + w, in glTF's order.
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
Quaternion normalize(Quaternion q);
/// Shortest-arc spherical interpolation, as glTF 2.0 (Appendix C) asks for.
Quaternion slerp(Quaternion a, Quaternion b, double weight);
Mat4 rotation(Quaternion q);

/// Camera placement: world from camera, camera looking along -z at `target`. The zero matrix where that is undefined.
Mat4 look_at(Vec3d eye, Vec3d target, Vec3d up);

}  // namespace kairos
