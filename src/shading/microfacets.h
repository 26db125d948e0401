// Directions in which even and rough surfaces scatter light, and how likely each is: Lambert's law and GGX.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <kairos/vec.h>

namespace kairos {

/// Two unit vectors across a unit one and each other: T. Duff and others 2017.
inline std::array<Vec3d, 2> axes_across(Vec3d n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {Vec3d{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, Vec3d{b, sign + n.y * n.y * a, -n.y}};
}

/// Distributed as the cosine over the hemisphere around `normal`.
inline Vec3d cosine_direction(Vec3d normal, float u, float v) {
  const double radius = std::sqrt(static_cast<double>(u)), angle = 2 * std::numbers::pi * static_cast<double>(v);
  const auto [x, y] = axes_across(normal);
  return normalize(x * (radius * std::cos(angle)) + y * (radius * std::sin(angle)) +
                   normal * std::sqrt(std::max(0.0, 1 - static_cast<double>(u))));
}

/// GGX's density of facets that face `half`, per steradian and area of the surface (B. Walter and others 2007).
inline double facet_density(Vec3d normal, Vec3d half, double alpha) {
  const double n_h = std::max(0.0, dot(normal, half)), a2 = alpha * alpha, slope = n_h * n_h * (a2 - 1) + 1;
  return a2 / (std::numbers::pi * slope * slope);
}

/// For a direction that has the cosine with the normal: the root by which facets hide each other there, times it.
inline double facet_slant(double cosine, double alpha) {
  const double a2 = alpha * alpha;
  return std::sqrt(cosine * cosine * (1 - a2) + a2);
}

/// GGX highlight (height-correlated shadowing, E. Heitz 2014), without its reflectance, per steradian. All vectors
/// unit; cosines with the normal positive.
inline double highlight_lobe(Vec3d normal, Vec3d to_viewer, Vec3d to_light, double alpha) {
  const Vec3d half = normalize(to_viewer + to_light);
  const double n_v = dot(normal, to_viewer), n_l = dot(normal, to_light);
  const double shadowing = n_l * facet_slant(n_v, alpha) + n_v * facet_slant(n_l, alpha);
  return shadowing > 0 ? facet_density(normal, half, alpha) / (2 * shadowing) : 0;
}

/// One of the facets that the viewer sees, by how much he sees of them (E. Heitz 2018): its normal. u, v: uniform in
/// [0, 1).
inline Vec3d visible_facet(Vec3d normal, Vec3d to_viewer, double alpha, float u, float v) {
  const auto [x, y] = axes_across(normal);
  const Vec3d view =
      normalize(Vec3d{alpha * dot(x, to_viewer), alpha * dot(y, to_viewer), std::max(dot(normal, to_viewer), 1e-9)});
  const double across = std::sqrt(view.x * view.x + view.y * view.y);
  const Vec3d a = across > 0 ? Vec3d{-view.y / across, view.x / across, 0} : Vec3d{1, 0, 0}, b = cross(view, a);
  const double radius = std::sqrt(static_cast<double>(u)), turn = 2 * std::numbers::pi * static_cast<double>(v);
  const double p = radius * std::cos(turn), bend = (1 + view.z) / 2;
  const double q = (1 - bend) * std::sqrt(std::max(0.0, 1 - p * p)) + bend * radius * std::sin(turn);
  const Vec3d m = a * p + b * q + view * std::sqrt(std::max(0.0, 1 - p * p - q * q));
  return normalize(x * (alpha * m.x) + y * (alpha * m.y) + normal * std::max(m.z, 0.0));
}

/// Of visible_facet, per steradian of its normals, divided by the facet's cosine with the viewer.
inline double visible_density(Vec3d normal, Vec3d to_viewer, Vec3d half, double alpha) {
  const double n_v = std::max(dot(normal, to_viewer), 1e-9);
  return 2 * facet_density(normal, half, alpha) / (n_v + facet_slant(n_v, alpha));
}

/// A direction in which the highlight shows light, by the facets that the viewer sees. u, v: uniform in [0, 1). May lie
/// below the surface.
inline Vec3d lobe_direction(Vec3d normal, Vec3d to_viewer, double alpha, float u, float v) {
  const Vec3d half = visible_facet(normal, to_viewer, alpha, u, v);
  return half * (2 * dot(half, to_viewer)) - to_viewer;
}

/// Of lobe_direction, per steradian. to_light on the side of the normal.
inline double lobe_density(Vec3d normal, Vec3d to_viewer, Vec3d to_light, double alpha) {
  return visible_density(normal, to_viewer, normalize(to_viewer + to_light), alpha) / 4;
}

}  // namespace kairos
