// How a point of a surface divides the light that falls on it: docs/method.md, "Whitted shading".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <kairos/scene.h>

#include "shading/looks.h"

namespace kairos {

/// Exact unpolarised reflectance of a smooth boundary. cosine: of the incoming ray, 0 to 1; eta: refractive index ahead
/// over that behind. 1 for total reflection.
inline double fresnel(double cosine, double eta) {
  const double sine_squared = (1 - cosine * cosine) / (eta * eta);
  if (sine_squared >= 1) return 1;
  const double inside = std::sqrt(1 - sine_squared);
  const double parallel = (eta * cosine - inside) / (eta * cosine + inside);
  const double perpendicular = (cosine - eta * inside) / (cosine + eta * inside);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/// Shares of the light from one direction: they sum to no more than 1 in each colour, and to 1 for a white surface.
struct Reflectance {
  Vec3f diffuse;     ///< scattered evenly (Lambert)
  Vec3f highlight;   ///< scattered around the mirror direction
  Vec3f mirror;      ///< reflected as by a mirror
  Vec3f through;     ///< let through, refracted
  double alpha = 1;  ///< width of the highlight: GGX's parameter
};

/// Rougher than this, nothing is a mirror any more.
inline constexpr float kRoughestMirror = 0.2f;

/// A layer of lacquer on what is there. A rough one has its highlight in the shape of what is below.
inline void add_clearcoat(const Material& material, double cosine, Reflectance& r) {
  constexpr double kIor = 1.5;
  const float share = material.clearcoat * static_cast<float>(fresnel(cosine, kIor)), below = 1 - share;
  const float smooth = std::max(0.0f, 1 - material.clearcoat_roughness / kRoughestMirror);
  const Vec3f white{1, 1, 1};
  r.mirror = r.mirror * below + white * (share * smooth);
  r.highlight = r.highlight * below + white * (share * (1 - smooth));
  r.diffuse = r.diffuse * below;
  r.through = r.through * below;
}

/// cosine: between the normal and the viewer, 0 to 1. entering: the ray comes from outside of the surface.
inline Reflectance reflectance(const Material& material, const Look& look, double cosine, bool entering) {
  const double ior = std::max(1.0f, material.ior);
  const bool can_leave = material.transmission > 0 && !material.thin_walled;
  double fresnel_share = fresnel(cosine, entering || !can_leave ? ior : 1 / ior);
  // Both faces of a thin wall, and what goes to and fro between them.
  if (material.thin_walled && material.transmission > 0) fresnel_share = 2 * fresnel_share / (1 + fresnel_share);

  const float rough = std::clamp(look.roughness, 0.0f, 1.0f), gloss = 1 - rough;
  const float metal = std::clamp(look.metallic, 0.0f, 1.0f), other = 1 - metal;
  const float smooth = std::max(0.0f, 1 - rough / kRoughestMirror);
  const float glass = material.transmission;
  const auto grazing = static_cast<float>(std::pow(1 - cosine, 5));  // C. Schlick 1994

  const Vec3f base = look.base_colour, white{1, 1, 1};
  const Vec3f metal_colour = base + (white - base) * (grazing * gloss);
  const float coat = static_cast<float>(fresnel_share) * (glass + gloss * (1 - glass));
  const float coat_mirror = glass + smooth * (1 - glass);

  // What the boundary of what is no metal reflects; the rest of the light goes on, less by the strongest colour of it.
  const Vec3f tint = (material.specular_color + (white - material.specular_color) * grazing) * material.specular;
  const Vec3f boundary{std::min(coat * tint.x, 1.0f), std::min(coat * tint.y, 1.0f), std::min(coat * tint.z, 1.0f)};
  const float inwards = 1 - std::max({boundary.x, boundary.y, boundary.z});

  Reflectance r;
  r.mirror = boundary * (other * coat_mirror) + metal_colour * (metal * smooth);
  r.highlight = boundary * (other * (1 - coat_mirror)) + metal_colour * (metal * (1 - smooth) * gloss);
  r.diffuse = base * (other * inwards * (1 - glass)) + metal_colour * (metal * (1 - smooth) * rough);
  r.through = base * (other * inwards * glass);
  r.alpha = std::max(rough, kRoughestMirror) * std::max(rough, kRoughestMirror);
  if (material.clearcoat > 0) add_clearcoat(material, cosine, r);
  return r;
}

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

/// GGX highlight (B. Walter and others 2007; height-correlated shadowing, E. Heitz 2014), without its reflectance, per
/// steradian. All vectors unit; cosines with the normal positive.
inline double highlight_lobe(Vec3d normal, Vec3d to_viewer, Vec3d to_light, double alpha) {
  const Vec3d half = normalize(to_viewer + to_light);
  const double n_h = std::max(0.0, dot(normal, half)), n_v = dot(normal, to_viewer), n_l = dot(normal, to_light);
  const double a2 = alpha * alpha, slope = n_h * n_h * (a2 - 1) + 1;
  const double spread = a2 / (std::numbers::pi * slope * slope);
  const double shadowing = n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2);
  return shadowing > 0 ? spread / (2 * shadowing) : 0;
}

/// A direction in which the highlight shows light, by the normals that the viewer sees (E. Heitz 2018). u, v: uniform
/// in [0, 1). May lie below the surface.
inline Vec3d lobe_direction(Vec3d normal, Vec3d to_viewer, double alpha, float u, float v) {
  const auto [x, y] = axes_across(normal);
  const Vec3d view =
      normalize(Vec3d{alpha * dot(x, to_viewer), alpha * dot(y, to_viewer), std::max(dot(normal, to_viewer), 1e-9)});
  const double across = std::sqrt(view.x * view.x + view.y * view.y);
  const Vec3d a = across > 0 ? Vec3d{-view.y / across, view.x / across, 0} : Vec3d{1, 0, 0}, b = cross(view, a);
  const double radius = std::sqrt(static_cast<double>(u)), turn = 2 * std::numbers::pi * static_cast<double>(v);
  const double p = radius * std::cos(turn), bend = (1 + view.z) / 2;
  const double q = (1 - bend) * std::sqrt(std::max(0.0, 1 - p * p)) + bend * radius * std::sin(turn);
  const Vec3d m = a * p + b * q + view * std::sqrt(std::max(0.0, 1 - p * p - q * q));
  const Vec3d half = normalize(x * (alpha * m.x) + y * (alpha * m.y) + normal * std::max(m.z, 0.0));
  return half * (2 * dot(half, to_viewer)) - to_viewer;
}

/// Of lobe_direction, per steradian. to_light on the side of the normal.
inline double lobe_density(Vec3d normal, Vec3d to_viewer, Vec3d to_light, double alpha) {
  const Vec3d half = normalize(to_viewer + to_light);
  const double n_h = std::max(0.0, dot(normal, half)), n_v = std::max(dot(normal, to_viewer), 1e-9), a2 = alpha * alpha;
  const double slope = n_h * n_h * (a2 - 1) + 1;
  const double spread = a2 / (std::numbers::pi * slope * slope);
  return spread / (2 * (n_v + std::sqrt(n_v * n_v * (1 - a2) + a2)));
}

}  // namespace kairos
