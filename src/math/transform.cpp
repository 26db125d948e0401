#include "math/transform.h"

#include <cmath>

namespace kairos {

Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 r;
  for (size_t c = 0; c < 4; ++c)
    for (size_t row = 0; row < 4; ++row) {
      double sum = 0;
      for (size_t k = 0; k < 4; ++k) sum += a.m[k][row] * b.m[c][k];
      r.m[c][row] = sum;
    }
  return r;
}

namespace {
Vec3d column(const Mat4& a, size_t c) { return {a.m[c][0], a.m[c][1], a.m[c][2]}; }
Mat4 from_columns(Vec3d x, Vec3d y, Vec3d z, Vec3d t) {
  return {{{{x.x, x.y, x.z, 0}, {y.x, y.y, y.z, 0}, {z.x, z.y, z.z, 0}, {t.x, t.y, t.z, 1}}}};
}
}  // namespace

double determinant3(const Mat4& a) { return dot(column(a, 0), cross(column(a, 1), column(a, 2))); }

Mat4 normal_matrix(const Mat4& a) {
  const Vec3d x = column(a, 0), y = column(a, 1), z = column(a, 2);
  return from_columns(cross(y, z), cross(z, x), cross(x, y), {});
}

Mat4 inverse_affine(const Mat4& a) {
  const Vec3d x = column(a, 0), y = column(a, 1), z = column(a, 2), t = column(a, 3);
  const double inv_det = 1 / determinant3(a);
  const Vec3d rx = cross(y, z) * inv_det, ry = cross(z, x) * inv_det, rz = cross(x, y) * inv_det;  // rows
  return from_columns({rx.x, ry.x, rz.x}, {rx.y, ry.y, rz.y}, {rx.z, ry.z, rz.z},
                      {-dot(rx, t), -dot(ry, t), -dot(rz, t)});
}

Mat4 translation(Vec3d t) { return from_columns({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t); }
Mat4 scaling(Vec3d s) { return from_columns({s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}); }

Quaternion normalize(Quaternion q) {
  const double len = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(len > 0) || !std::isfinite(len)) return {};
  return {q.x / len, q.y / len, q.z / len, q.w / len};
}

Quaternion slerp(Quaternion a, Quaternion b, double weight) {
  double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  if (cosine < 0) {
    b = {-b.x, -b.y, -b.z, -b.w};
    cosine = -cosine;
  }
  // Below this angle (about 1e-4 rad) the chord is the arc to within double precision.
  constexpr double kNearlyParallel = 1 - 1e-9;
  double wa = 1 - weight, wb = weight;
  if (cosine < kNearlyParallel) {
    const double angle = std::acos(cosine), inv_sine = 1 / std::sin(angle);
    wa = std::sin(wa * angle) * inv_sine;
    wb = std::sin(wb * angle) * inv_sine;
  }
  return normalize({a.x * wa + b.x * wb, a.y * wa + b.y * wb, a.z * wa + b.z * wb, a.w * wa + b.w * wb});
}

Mat4 rotation(Quaternion q) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  return from_columns({1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                      {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                      {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}, {});
}

Mat4 look_at(Vec3d eye, Vec3d target, Vec3d up) {
  const Vec3d back = normalize(eye - target);
  const Vec3d right = normalize(cross(up, back));
  return from_columns(right, cross(back, right), back, eye);
}

}  // namespace kairos
