#include "shading/scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shading/facet_energy.h"
#include "shading/first_points.h"
#include "shading/microfacets.h"

namespace kairos {

namespace {

double squared_roughness(float roughness) {
  const auto r = static_cast<double>(std::clamp(roughness, 0.0f, 1.0f));
  return r * r;
}

double viewer_cosine(const SurfacePoint& p) { return std::clamp(dot(p.normal, p.to_viewer), 0.0, 1.0); }

/// To the other side of the surface.
Vec3d through_plane(Vec3d direction, Vec3d normal) { return reflected(direction, normal); }

}  // namespace

Vec3f straight_share(const SurfacePoint& point) {
  if (!is_lit(point) || !is_straight(*point.material, point.look)) return {};
  return reflectance(*point.material, point.look, viewer_cosine(point), point.entering).through;
}

Scattering::Scattering(const SurfacePoint& point)
    : point_(point),
      boundary_(*point.material, point.look, point.entering),
      metal_(std::clamp(point.look.metallic, 0.0f, 1.0f)),
      facets_alpha_(squared_roughness(point.look.roughness)),
      coat_alpha_(squared_roughness(point.material->clearcoat_roughness)),
      facets_sharp_(facets_alpha_ < kSmoothest),
      coat_sharp_(coat_alpha_ < kSmoothest),
      refracts_(point.material->transmission > 0 && metal_ < 1 && !is_straight(*point.material, point.look)),
      is_dark_(true) {
  if (!is_lit(point)) return;
  const double cosine = viewer_cosine(point);
  const float coat = point.material->clearcoat > 0 ? clearcoat_reflects(*point.material, cosine) : 0;
  below_ = 1 - coat;
  if (metal_ > 0 && !facets_sharp_) {
    const double once = reflected_once(cosine, facets_alpha_);
    for (int c = 0; c < 3; ++c) {
      const auto base = static_cast<double>(std::clamp(point.look.base_colour[c], 0.0f, 1.0f));
      again_[c] = static_cast<float>(all_reflections(once, base));
    }
  }
  if (lets_through()) {
    const double once = point.material->thin_walled
                            ? reflected_once(cosine, facets_alpha_)
                            : reflected_or_refracted_once(cosine, facets_alpha_, boundary_.eta());
    border_again_ = static_cast<float>(all_reflections(once, static_cast<double>(point.material->transmission)));
    for (int c = 0; c < 3; ++c) {
      const auto base = static_cast<double>(std::clamp(point.look.base_colour[c], 0.0f, 1.0f));
      through_again_[c] = static_cast<float>(all_reflections(once, base));
    }
  }
  const float inwards = 1 - largest(boundary_.reflects(cosine));
  even_ = point.look.base_colour * ((1 - metal_) * inwards * (1 - point.material->transmission) * below_);
  const auto even = static_cast<double>(largest(even_)), top = static_cast<double>(coat);
  const auto facets = static_cast<double>(largest(reflects(cosine)) + largest(refracts(cosine)));
  const double sum = even + facets + top;
  if (!(sum > 0) || !std::isfinite(sum)) {
    even_ = {};
    return;
  }
  even_chance_ = even / sum;
  facets_chance_ = facets / sum;
  is_dark_ = !(even > 0) && (facets_sharp_ || !(facets > 0)) && (coat_sharp_ || !(top > 0));
}

bool Scattering::is_broad() const {
  return point_.material->transmission == 0 && !facets_sharp_ && !(point_.material->clearcoat > 0 && coat_sharp_);
}

Vec3f Scattering::reflects() const {
  const float coat = 1 - below_;
  return even_ + reflects(viewer_cosine(point_)) + Vec3f{coat, coat, coat};
}

Vec3f Scattering::reflects(double cosine) const {
  const Vec3f base = point_.look.base_colour, white{1, 1, 1};
  const auto grazing = static_cast<float>(std::pow(1 - cosine, 5));
  const Vec3f metal = base + (white - base) * grazing;
  return (metal * again_ * metal_ + boundary_.reflects(cosine) * (border_again_ * (1 - metal_))) * below_;
}

Vec3f Scattering::refracts(double cosine) const {
  if (!refracts_) return {};
  const double eta = boundary_.eta();
  const bool bends = !point_.material->thin_walled;
  if (bends && 1 - cosine * cosine >= eta * eta) return {};  // all is reflected
  const float share = (1 - metal_) * point_.material->transmission * (1 - largest(boundary_.reflects(cosine))) * below_;
  return point_.look.base_colour * through_again_ * share;
}

double Scattering::reflect_chance(double cosine) const {
  const auto back = static_cast<double>(largest(reflects(cosine))), on = static_cast<double>(largest(refracts(cosine)));
  return back + on > 0 ? back / (back + on) : 1;
}

Vec3d Scattering::bending_facet(Vec3d direction) const {
  Vec3d half = normalize(point_.to_viewer + direction * boundary_.eta());
  if (dot(half, point_.normal) < 0) half = -half;
  return dot(half, point_.to_viewer) > 0 && dot(half, direction) < 0 ? half : Vec3d{};
}

Vec3f Scattering::value(Vec3d direction) const {
  if (is_dark_) return {};
  const Vec3d normal = point_.normal, viewer = point_.to_viewer;
  const double cosine = dot(normal, direction), face = dot(point_.face, direction);
  if (cosine > 0 && face > 0) {
    Vec3f value = even_ * static_cast<float>(1 / std::numbers::pi);
    const double facing = std::clamp(dot(normalize(viewer + direction), viewer), 0.0, 1.0);
    if (!facets_sharp_)
      value += reflects(facing) * static_cast<float>(highlight_lobe(normal, viewer, direction, facets_alpha_));
    if (below_ < 1 && !coat_sharp_)
      value += Vec3f{1, 1, 1} * (clearcoat_reflects(*point_.material, facing) *
                                 static_cast<float>(highlight_lobe(normal, viewer, direction, coat_alpha_)));
    return value * static_cast<float>(cosine);
  }
  if (!lets_through() || !(cosine < 0) || !(face < 0)) return {};
  if (point_.material->thin_walled) {
    const Vec3d mirrored = through_plane(direction, normal);
    const double facing = std::clamp(dot(normalize(viewer + mirrored), viewer), 0.0, 1.0);
    return refracts(facing) * static_cast<float>(-cosine * highlight_lobe(normal, viewer, mirrored, facets_alpha_));
  }
  // B. Walter and others 2007, with shadowing as in highlight_lobe().
  const Vec3d half = bending_facet(direction);
  if (half == Vec3d{}) return {};
  const double v_h = dot(viewer, half), l_h = dot(direction, half), n_v = dot(normal, viewer);
  const double width = v_h + boundary_.eta() * l_h;
  const double slants = -cosine * facet_slant(n_v, facets_alpha_) + n_v * facet_slant(cosine, facets_alpha_);
  const double lobe = 2 * facet_density(normal, half, facets_alpha_) * -cosine * v_h * -l_h / (slants * width * width);
  return refracts(v_h) * static_cast<float>(lobe);
}

double Scattering::density(Vec3d direction) const {
  if (is_dark_) return 0;
  const Vec3d normal = point_.normal, viewer = point_.to_viewer;
  const double cosine = dot(normal, direction);
  if (cosine > 0) {
    double density = even_chance_ * cosine / std::numbers::pi;
    const Vec3d half = normalize(viewer + direction);
    if (facets_chance_ > 0 && !facets_sharp_)
      density += facets_chance_ * reflect_chance(std::clamp(dot(half, viewer), 0.0, 1.0)) *
                 visible_density(normal, viewer, half, facets_alpha_) / 4;
    const double coat_chance = 1 - even_chance_ - facets_chance_;
    if (below_ < 1 && !coat_sharp_) density += coat_chance * visible_density(normal, viewer, half, coat_alpha_) / 4;
    return density;
  }
  if (!lets_through() || !(cosine < 0)) return 0;
  if (point_.material->thin_walled) {
    const Vec3d half = normalize(viewer + through_plane(direction, normal));
    return facets_chance_ * (1 - reflect_chance(std::clamp(dot(half, viewer), 0.0, 1.0))) *
           visible_density(normal, viewer, half, facets_alpha_) / 4;
  }
  const Vec3d half = bending_facet(direction);
  if (half == Vec3d{}) return 0;
  const double v_h = dot(viewer, half), l_h = dot(direction, half), eta = boundary_.eta(), width = v_h + eta * l_h;
  return facets_chance_ * (1 - reflect_chance(v_h)) * visible_density(normal, viewer, half, facets_alpha_) * v_h * eta *
         eta * -l_h / (width * width);
}

std::optional<Scattering::Sample> Scattering::rough_sample(Vec3d direction, double side) const {
  if (!(side * dot(point_.normal, direction) > 0)) return std::nullopt;
  const double likely = density(direction);
  const Vec3f weight = value(direction) * static_cast<float>(1 / likely);
  if (!(likely > 0) || weight == Vec3f{} || !is_finite(weight)) return std::nullopt;
  return Sample{direction, weight, likely};
}

std::optional<Scattering::Sample> Scattering::sample(const std::array<float, 3>& random) const {
  const Vec3d normal = point_.normal, viewer = point_.to_viewer;
  auto pick = static_cast<double>(random[2]);
  if (even_chance_ + facets_chance_ == 0 && !(below_ < 1)) return std::nullopt;
  if (pick < even_chance_) return rough_sample(cosine_direction(normal, random[0], random[1]), 1);
  // By the triangle's own plane where the bent one would send light into it.
  const auto mirrored = [&] {
    const Vec3d direction = reflected(-viewer, normal);
    return dot(direction, point_.face) > 0 ? direction : reflected(-viewer, point_.face);
  };
  pick -= even_chance_;
  if (!(pick < facets_chance_) && below_ < 1) {
    if (!coat_sharp_) return rough_sample(lobe_direction(normal, viewer, coat_alpha_, random[0], random[1]), 1);
    const double chance = 1 - even_chance_ - facets_chance_;
    const float share = (1 - below_) / static_cast<float>(chance);
    return Sample{mirrored(), Vec3f{share, share, share}};
  }
  if (!(facets_chance_ > 0)) return std::nullopt;
  pick = std::min(pick / facets_chance_, 1.0);
  const Vec3d facet = facets_sharp_ ? normal : visible_facet(normal, viewer, facets_alpha_, random[0], random[1]);
  const double cosine = std::clamp(dot(facet, viewer), 0.0, 1.0), back = reflect_chance(cosine);
  const double eta = boundary_.eta();
  const bool thin = point_.material->thin_walled;
  if (pick < back || back == 1) {
    if (!facets_sharp_) return rough_sample(reflected(-viewer, facet), 1);
    return Sample{mirrored(), reflects(cosine) * static_cast<float>(1 / (facets_chance_ * back))};
  }
  if (!facets_sharp_)
    return rough_sample(thin ? through_plane(reflected(-viewer, facet), normal) : refracted(-viewer, facet, eta), -1);
  Vec3d inwards = refracted(-viewer, normal, eta);
  if (!(dot(inwards, point_.face) < 0)) inwards = -viewer;
  // Light is denser in what is denser: as much of it comes from fewer directions there.
  return Sample{inwards, refracts(cosine) * static_cast<float>(1 / (facets_chance_ * (1 - back) * eta * eta))};
}

}  // namespace kairos
