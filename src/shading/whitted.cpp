#include "shading/whitted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "shading/first_points.h"
#include "shading/microfacets.h"

namespace kairos {

namespace {

// A reflection that would add less than this part of its colour to the picture is left out: half a step of 8 bits.
constexpr float kLeastWeight = 1.0f / 512;
// Branches of a sample's key, beside those of DirectLight.
constexpr uint64_t kEnvironmentBranch = 12, kMirrorBranch = 13, kThroughBranch = 14, kScatterBranch = 16;

Reflectance shares_at(const SurfacePoint& p) {
  if (!is_lit(p)) return {};
  return reflectance(*p.material, p.look, std::clamp(dot(p.normal, p.to_viewer), 0.0, 1.0), p.entering);
}

}  // namespace

Whitted::Scatter::Scatter(const SurfacePoint& point)
    : normal_(point.normal), face_(point.face), to_viewer_(point.to_viewer), shares_(shares_at(point)) {
  const auto even = static_cast<double>(largest(shares_.diffuse)),
             bright = static_cast<double>(largest(shares_.highlight));
  is_dark_ = !(even + bright > 0);
  by_cosine_ = is_dark_ ? 1 : even / (even + bright);
  // In the middle of the highlight it is brighter than all the rest: highlight / (4 pi alpha^2) against diffuse / pi.
  is_sharp_ = bright > 4 * shares_.alpha * shares_.alpha * even;
}

Vec3f Whitted::Scatter::value(Vec3d direction) const {
  const double cosine = dot(normal_, direction);
  if (!(cosine > 0) || !(dot(face_, direction) > 0)) return {};
  Vec3f value = shares_.diffuse * static_cast<float>(1 / std::numbers::pi);
  if (shares_.highlight != Vec3f{})
    value += shares_.highlight * static_cast<float>(highlight_lobe(normal_, to_viewer_, direction, shares_.alpha));
  return value * static_cast<float>(cosine);
}

double Whitted::Scatter::density(Vec3d direction) const {
  const double cosine = dot(normal_, direction);
  if (!(cosine > 0)) return 0;
  const double even = by_cosine_ * cosine / std::numbers::pi;
  return by_cosine_ < 1 ? even + (1 - by_cosine_) * lobe_density(normal_, to_viewer_, direction, shares_.alpha) : even;
}

Vec3d Whitted::Scatter::direction(const std::array<float, 3>& sample) const {
  return static_cast<double>(sample[2]) < by_cosine_
             ? cosine_direction(normal_, sample[0], sample[1])
             : lobe_direction(normal_, to_viewer_, shares_.alpha, sample[0], sample[1]);
}

Whitted::Whitted(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
                 double cone_spread, int max_depth)
    : points_(shot, looks),
      lights_(shot, looks, sky),
      shadows_(looks, points_, std::move(scene)),
      direct_(lights_, shadows_),
      cone_spread_(cone_spread),
      max_depth_(max_depth) {}

void Whitted::resting_light(const ShadingQuery& query, std::vector<RestingLight>& lights) const {
  add_resting_light(query, points_, direct_, lights);
}

void Whitted::radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const {
  shade_together(queries, colours, points_, direct_, true,
                 [&](const ShadingQuery& query, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual,
                     const SampleInstant& instant) {
                   return shade(query.ray, point, scatter, punctual, instant, query.key, past_of(query));
                 });
}

void Whitted::own_light(std::span<const ShadingQuery> queries, bool share_asked,
                        std::span<SharedSurface> surfaces) const {
  visit_together(
      queries, points_, direct_, !share_asked,
      [&](size_t i, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual, const SampleInstant& instant) {
        SharedSurface& surface = surfaces[i];
        surface = {{}, {}, point.weights, point.entering};
        if (is_lit(point) && scatter.is_narrow()) {
          const Past past = past_of(queries[i]);
          surface.own = share_asked ? shade(queries[i].ray, point, instant, queries[i].key, past)
                                    : shade(queries[i].ray, point, scatter, punctual, instant, queries[i].key, past);
        } else if (is_lit(point)) {
          surface.own = point.look.emission + punctual +
                        followed(queries[i].ray, point, scatter, instant, queries[i].key, past_of(queries[i]));
          surface.reflects = scatter.shares().diffuse + scatter.shares().highlight;
        } else if (point.face != Vec3d{}) {
          surface.own = point.look.base_colour;
        }
        if (!is_finite(surface.own)) surface.own = {};
      });
}

void Whitted::shared_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<Vec3f> colours) const {
  shade_together(
      queries, colours, points_, direct_, share_asked,
      [&](const ShadingQuery& query, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual,
          const SampleInstant& instant) { return punctual + by_chance(point, scatter, instant, query.key); });
}

Vec3f Whitted::shade(const Ray& ray, const SurfacePoint& point, const SampleInstant& instant, SampleKey key,
                     const Past& past) const {
  const Scatter scatter(point);
  Vec3f punctual{};
  direct_.add_asked({&point, 1}, {&scatter, 1}, {&instant, 1}, {&punctual, 1});
  return shade(ray, point, scatter, punctual, instant, key, past);
}

Vec3f Whitted::shade(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual,
                     const SampleInstant& instant, SampleKey key, const Past& past) const {
  if (point.face == Vec3d{}) return {};  // no area
  if (point.material->unlit) return point.look.base_colour;
  return point.look.emission + punctual + by_chance(point, scatter, instant, key) +
         followed(ray, point, scatter, instant, key, past);
}

template <class Follow>
void Whitted::visit_followed(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, const Past& past,
                             const Follow& follow) const {
  const Reflectance& shares = scatter.shares();
  if (past.depth >= max_depth_ ||
      past.weight * std::max(largest(shares.mirror), largest(shares.through)) < kLeastWeight)
    return;
  const Vec3d along = normalize(to_double(ray.direction));
  const auto send = [&](Vec3f share, Vec3d direction, double side, uint64_t branch) {
    const float rest = past.weight * largest(share);
    if (rest >= kLeastWeight) follow(share, point.ray(direction, side), rest, branch);
  };
  Vec3d mirrored = reflected(along, point.normal);
  if (!(dot(mirrored, point.face) > 0)) mirrored = reflected(along, point.face);
  send(shares.mirror, mirrored, 1, kMirrorBranch);
  const double ior = std::max(1.0f, point.material->ior);
  const double eta = point.material->thin_walled ? 1 : point.entering ? ior : 1 / ior;
  Vec3d inwards = refracted(along, point.normal, eta);
  if (!(dot(inwards, point.face) < 0)) inwards = along;
  send(shares.through, inwards, -1, kThroughBranch);
}

Vec3f Whitted::followed(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                        SampleKey key, const Past& past) const {
  Vec3f colour{};
  visit_followed(ray, point, scatter, past, [&](Vec3f share, const Ray& onwards, float rest, uint64_t branch) {
    if (rest >= past.followed_elsewhere) return;
    const bool still = past.still_in != nullptr && (*past.still_in)[point.mesh] && rest >= kLeastExact;
    Past beyond{past.depth + 1, rest};
    if (still) beyond.still_in = past.still_in;
    colour += share * from(onwards, point.width, instant, key.branch(branch), beyond,
                           still ? DiscreteLayer::still : DiscreteLayer::all);
  });
  return colour;
}

void Whitted::followed_rays(const ShadingQuery& query, std::vector<FollowedRay>& rays) const {
  const SampleInstant instant = points_.instant(query.time);
  const SurfacePoint point = points_.at(query.ray, query.mesh, query.triangle, query.width, instant);
  if (!kairos::is_lit(point)) return;
  visit_followed(query.ray, point, Scatter(point), past_of(query),
                 [&](Vec3f share, const Ray& onwards, float /*rest*/, uint64_t /*branch*/) {
                   rays.push_back({onwards, share, point.width});
                 });
}

Vec3f Whitted::beyond(const Ray& ray, float time) const {
  const Vec3d in_world = points_.instant(time).place.vector_to_world(normalize(to_double(ray.direction)));
  return lights_.beyond(in_world, cone_spread_);
}

Vec3f Whitted::from(const Ray& ray, double width, const SampleInstant& instant, SampleKey key, const Past& past,
                    DiscreteLayer layer) const {
  std::optional<DiscreteHit> hit;
  if (layer == DiscreteLayer::all)
    hit = shadows_.scene().intersect(ray, instant.time);
  else
    shadows_.scene().intersect({&ray, 1}, {&instant.time, 1}, {&hit, 1}, layer);
  if (!hit) return lights_.beyond(instant.place.vector_to_world(normalize(to_double(ray.direction))), cone_spread_);
  const double there = width + cone_spread_ * static_cast<double>(hit->dist);
  return shade(ray, points_.at(ray, hit->mesh, hit->triangle, there, instant), instant, key, past);
}

Vec3f Whitted::by_chance(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                         SampleKey key) const {
  if (scatter.is_dark()) return {};
  AreaLights::View view(lights_.areas(), point.position, point.normal, instant.time);
  const Vec3f colour = by_choice(point, scatter, instant, view, key, direct_.tracing(point, instant));
  return colour + by_scattering(point, scatter, instant, view, key);
}

template <class Arrive>
Vec3f Whitted::by_choice(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                         AreaLights::View& view, SampleKey key, const Arrive& arrive) const {
  Vec3f colour = direct_.by_choice(point, scatter, instant, view, key, arrive);
  if (lights_.has_environment()) {
    const std::array<float, 3> sample = light_point(key.branch(kEnvironmentBranch));
    const Vec3d direction = cosine_direction(point.normal, sample[0], sample[1]);
    if (dot(point.face, direction) > 0)
      colour += arrive((scatter.shares().diffuse + scatter.shares().highlight) * lights_.environment(), direction,
                       std::numeric_limits<double>::infinity(), Glass::straight);
  }
  return colour;
}

bool Whitted::steady_light(const ShadingQuery& query, std::vector<RestingLight>& lights, Vec3f& own) const {
  const SampleInstant instant = points_.instant(query.time);
  const SurfacePoint point = points_.at(query.ray, query.mesh, query.triangle, query.width, instant);
  own = is_lit(point) ? point.look.emission : point.face == Vec3d{} ? Vec3f{} : point.look.base_colour;
  if (!is_lit(point)) return true;
  const Scatter scatter(point);
  const Reflectance& shares = scatter.shares();
  const bool follows = max_depth_ > 0 && std::max(largest(shares.mirror), largest(shares.through)) >= kLeastWeight;
  if (follows || !lights_.rest() || meets_areas(scatter)) return false;
  direct_.add_resting(point, scatter, instant, lights);
  if (scatter.is_dark()) return true;
  AreaLights::View view(lights_.areas(), point.position, point.normal, instant.time);
  const auto note = direct_.collecting(point, lights);
  by_choice(point, scatter, instant, view, query.key, note);
  if (!lights_.sky().empty())
    direct_.from_sky(scatter, scatter.direction(light_point(query.key.branch(kScatterBranch))), instant, note);
  return true;
}

/// One direction by how the surface scatters: of it, what lights and the sky bring is weighed as by_choice() weighs it.
Vec3f Whitted::by_scattering(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                             AreaLights::View& view, SampleKey key) const {
  const bool has_sky = !lights_.sky().empty(), for_areas = meets_areas(scatter);
  if (!has_sky && !for_areas) return {};
  const Vec3d direction = scatter.direction(light_point(key.branch(kScatterBranch)));
  if (!for_areas) return direct_.from_sky(point, scatter, direction, instant);
  const Vec3f value = scatter.value(direction);
  if (value == Vec3f{}) return {};
  const auto there = shadows_.look(point, direction, instant);
  if (!there) return {};
  if (!there->hit) {
    if (!has_sky) return {};
    const Vec3d in_world = instant.place.vector_to_world(direction);
    const double density = lights_.sky().density(in_world) + scatter.sky_density(direction);
    if (!(density > 0)) return {};
    return value * there->open * lights_.sky().radiance(in_world) * static_cast<float>(1 / density);
  }
  const auto light = view.met(there->hit->mesh, there->hit->triangle, direction, there->hit->dist);
  if (!light) return {};
  const double density = light->density + scatter.area_density(direction);
  const Vec3f colour = value * there->open * light->radiance * static_cast<float>(1 / density);
  return is_finite(colour) ? colour : Vec3f{};
}

}  // namespace kairos
