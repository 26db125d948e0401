// Coordinates in which a ray is the third axis: the first two of a point say how far it is off the ray, and to which
// side.
#pragma once

#include <algorithm>
#include <cmath>

#include <kairos/tracer.h>
#include <kairos/vec.h>

namespace kairos {

/// Shear-and-permute frame of a ray (Woop, Benthin, Wald: "Watertight Ray/Triangle Intersection", JCGT 2013, section
/// 2). A point p relative to the origin has u = p[ku] - shear_u p[kw], v = p[kv] - shear_v p[kw], dist = inv_w p[kw].
/// Axes u and v are exchanged where the direction's w is negative, so that a triangle whose vertices run
/// counter-clockwise seen from the origin has positive edge functions (see edge_function) whatever the direction.
template <class Real>
struct RayFrame {
  Vec3f origin;
  int ku = 0, kv = 1, kw = 2;
  Real shear_u = 0, shear_v = 0, inv_w = 0;

  explicit RayFrame(const Ray& ray) : origin(ray.origin) {
    const Vec3f d = ray.direction;
    const float ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    kw = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    ku = (kw + 1) % 3;
    kv = (kw + 2) % 3;
    if (d[kw] < 0) {
      const int swapped = ku;
      ku = kv;
      kv = swapped;
    }
    inv_w = Real(1) / Real(d[kw]);
    shear_u = Real(d[ku]) * inv_w;
    shear_v = Real(d[kv]) * inv_w;
  }
};

/// A ray whose direction's largest component is between 2^-32 and 2^32, so that nothing computed with it over- or
/// underflows: along it, distances are those along the given ray times 2^exponent. Scaling by a power of two changes no
/// other bit. Most rays are left as they are. Geometry may be scaled, too: see working_exponent.
struct ScaledRay {
  Ray ray;
  int exponent = 0;
  double ahead = 0;  ///< how far the origin has been moved along the ray, in distances along `ray`

  ScaledRay() = default;
  /// geometry: what is traced is 2^geometry times as large as what was given.
  explicit ScaledRay(const Ray& given, int geometry = 0) : ray(given), exponent(geometry) {
    if (geometry != 0)
      for (int k = 0; k < 3; ++k) ray.origin[k] = std::ldexp(ray.origin[k], geometry);
    const float largest =
        std::max({std::abs(given.direction.x), std::abs(given.direction.y), std::abs(given.direction.z)});
    if ((largest >= 0x1p-32f && largest <= 0x1p32f) || !(largest > 0) || !std::isfinite(largest)) return;
    const int length = std::ilogb(largest);
    for (int k = 0; k < 3; ++k) ray.direction[k] = std::ldexp(ray.direction[k], -length);
    exponent += length;
  }

  /// Moves the origin of a ray that comes from so far that products of coordinates would overflow to where it comes
  /// near all that there is, within `extent` of zero in each coordinate; but no further than `max_dist`, a given
  /// distance.
  void come_near(float extent, float max_dist) {
    constexpr float kFar = 0x1p30f, kBeyond = 4;
    const float reach = std::max({std::abs(ray.origin.x), std::abs(ray.origin.y), std::abs(ray.origin.z)});
    if (!(reach > kFar && reach > kBeyond * extent) || !std::isfinite(reach)) return;
    const Vec3d origin = to_double(ray.origin), direction = to_double(ray.direction);
    const double speed = length(direction), margin = kBeyond * static_cast<double>(extent) / speed;
    const double to = -dot(origin, direction) / (speed * speed) - margin;
    if (!(to > 0 && to < std::ldexp(static_cast<double>(max_dist), exponent))) return;
    ahead = to;
    ray.origin = to_float(origin + direction * to);
  }

  bool is_as_given() const { return exponent == 0 && ahead == 0; }
  float to_given(float dist) const {
    return ahead == 0 ? std::ldexp(dist, -exponent)
                      : static_cast<float>(std::ldexp(static_cast<double>(dist) + ahead, -exponent));
  }
  float from_given(float dist) const {
    return ahead == 0 ? std::ldexp(dist, exponent)
                      : static_cast<float>(std::ldexp(static_cast<double>(dist), exponent) - ahead);
  }
};

/// True for rays that can meet anything: finite, with a direction.
inline bool is_traceable(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3f{};
}

}  // namespace kairos
