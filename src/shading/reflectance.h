// How a point of a surface divides the light that falls on it: docs/method.md, "Whitted shading".
#pragma once

#include <algorithm>
#include <cmath>

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

/// Of a mirror; both unit.
inline Vec3d reflected(Vec3d direction, Vec3d normal) { return direction - normal * (2 * dot(direction, normal)); }

/// eta: refractive index ahead over that behind; normal: towards where the ray comes from. The ray must not be totally
/// reflected.
inline Vec3d refracted(Vec3d direction, Vec3d normal, double eta) {
  const double cosine = -dot(direction, normal);
  const double inside = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (eta * eta)));
  return normalize(direction / eta + normal * (cosine / eta - inside));
}

/// The strongest of a colour's components.
inline float largest(Vec3f c) { return std::max({c.x, c.y, c.z}); }

/// Shares of the light from one direction: they sum to no more than 1 in each colour, and to 1 for a white surface.
struct Reflectance {
  Vec3f diffuse;     ///< scattered evenly (Lambert)
  Vec3f highlight;   ///< scattered around the mirror direction
  Vec3f mirror;      ///< reflected as by a mirror
  Vec3f through;     ///< let through, refracted
  double alpha = 1;  ///< width of the highlight: GGX's parameter
};

/// For paths: facets are a mirror, or clear glass, where GGX's parameter, the square of roughness, is below.
inline constexpr double kSmoothest = 1e-3;

/// Does what lets light through let it go straight on here?
inline bool is_straight(const Material& material, const Look& look) {
  const double roughness = look.roughness;
  return material.transmission > 0 && material.thin_walled && roughness * roughness < kSmoothest;
}

/// In Whitted's shading: rougher than this, nothing is a mirror any more.
inline constexpr float kRoughestMirror = 0.2f;

/// The share that a layer of lacquer reflects.
inline float clearcoat_reflects(const Material& material, double cosine) {
  constexpr double kIor = 1.5;
  return material.clearcoat * static_cast<float>(fresnel(cosine, kIor));
}

/// A layer of lacquer on what is there. A rough one has its highlight in the shape of what is below.
inline void add_clearcoat(const Material& material, double cosine, Reflectance& r) {
  const float share = clearcoat_reflects(material, cosine), below = 1 - share;
  const float smooth = std::max(0.0f, 1 - material.clearcoat_roughness / kRoughestMirror);
  const Vec3f white{1, 1, 1};
  r.mirror = r.mirror * below + white * (share * smooth);
  r.highlight = r.highlight * below + white * (share * (1 - smooth));
  r.diffuse = r.diffuse * below;
  r.through = r.through * below;
}

/// The border of what is no metal.
class Boundary {
 public:
  /// entering: the ray comes from outside of the surface.
  Boundary(const Material& material, const Look& look, bool entering) : material_(material) {
    const double ior = std::max(1.0f, material.ior);
    const bool can_leave = material.transmission > 0 && !material.thin_walled;
    eta_ = entering || !can_leave ? ior : 1 / ior;
    const float glass = material.transmission, gloss = 1 - std::clamp(look.roughness, 0.0f, 1.0f);
    strength_ = glass + gloss * (1 - glass);
  }
  /// Refractive index ahead over that behind.
  double eta() const { return eta_; }
  /// The share that it reflects. cosine: of the incoming ray with what it is reflected by, 0 to 1.
  Vec3f reflects(double cosine) const {
    double share = fresnel(cosine, eta_);
    // Both faces of a thin wall, and what goes to and fro between them.
    if (material_.thin_walled && material_.transmission > 0) share = 2 * share / (1 + share);
    const Vec3f white{1, 1, 1};
    const float coat = static_cast<float>(share) * strength_;
    const auto grazing = static_cast<float>(std::pow(1 - cosine, 5));  // C. Schlick 1994
    const Vec3f tint = (material_.specular_color + (white - material_.specular_color) * grazing) * material_.specular;
    return {std::min(coat * tint.x, 1.0f), std::min(coat * tint.y, 1.0f), std::min(coat * tint.z, 1.0f)};
  }

 private:
  const Material& material_;
  double eta_;
  float strength_;
};

/// cosine: between the normal and the viewer, 0 to 1. entering: the ray comes from outside of the surface.
inline Reflectance reflectance(const Material& material, const Look& look, double cosine, bool entering) {
  const float rough = std::clamp(look.roughness, 0.0f, 1.0f), gloss = 1 - rough;
  const float metal = std::clamp(look.metallic, 0.0f, 1.0f), other = 1 - metal;
  const float smooth = std::max(0.0f, 1 - rough / kRoughestMirror);
  const float glass = material.transmission;
  const auto grazing = static_cast<float>(std::pow(1 - cosine, 5));  // C. Schlick 1994

  const Vec3f base = look.base_colour, white{1, 1, 1};
  const Vec3f metal_colour = base + (white - base) * (grazing * gloss);
  const float coat_mirror = glass + smooth * (1 - glass);

  // What the boundary of what is no metal reflects; the rest of the light goes on, less by the strongest colour of it.
  const Vec3f boundary = Boundary(material, look, entering).reflects(cosine);
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

}  // namespace kairos
