// A triangle as a point sees it: how much of all directions it takes, and directions spread evenly over it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <kairos/vec.h>

namespace kairos {

/// Corners relative to the point; any lengths, none zero. Steradians: A. van Oosterom and J. Strackee 1983.
inline double solid_angle(const std::array<Vec3d, 3>& corners) {
  const auto& [a, b, c] = corners;
  const double la = length(a), lb = length(b), lc = length(c);
  const double volume = std::abs(dot(a, cross(b, c)));
  return 2 * std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// A direction spread evenly over the triangle's solid angle, which is `solid`: J. Arvo, Stratified Sampling of
/// Spherical Triangles, 1995. u, v: uniform in [0, 1). Unit; zero where the triangle is too thin for the formulas.
inline Vec3d spherical_triangle_direction(const std::array<Vec3d, 3>& corners, double solid, double u, double v) {
  const Vec3d a = normalize(corners[0]), b = normalize(corners[1]), c = normalize(corners[2]);
  const Vec3d ab = normalize(cross(a, b)), ca = normalize(cross(c, a));
  const double cos_a = std::clamp(-dot(ab, ca), -1.0, 1.0), sin_a = std::sqrt(1 - cos_a * cos_a);
  if (!(sin_a > 0)) return {};
  const double part = u * solid;  // of the area, cut off along an arc through b
  const double s = std::sin(part) * cos_a - std::cos(part) * sin_a, t = std::cos(part) * cos_a + std::sin(part) * sin_a;
  const double p = t - cos_a, q = s + sin_a * dot(a, b);
  const double below = (q * s + p * t) * sin_a;
  const double along = below != 0 ? std::clamp(((q * t - p * s) * cos_a - q) / below, -1.0, 1.0) : 1;
  const auto across = [](Vec3d from, Vec3d axis) { return normalize(from - axis * dot(from, axis)); };
  const Vec3d cut = a * along + across(c, a) * std::sqrt(1 - along * along);
  const double z = 1 - v * (1 - dot(cut, b));
  return normalize(b * z + across(cut, b) * std::sqrt(std::max(0.0, 1 - z * z)));
}

}  // namespace kairos
