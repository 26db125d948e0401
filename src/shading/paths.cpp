#include "shading/paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "math/hash.h"
#include "shading/first_points.h"

namespace kairos {

namespace {

// Branches of a sample's key, beside those of DirectLight.
constexpr uint64_t kWayBranch = 16, kBehindBranch = 18, kBounceBranch = 19, kPassBranch = 20;
constexpr uint64_t kRouletteDimension = 5;
// From this many bounces on, chance ends paths that have little to bring.
constexpr int kSureBounces = 3;
// Thin walls that a path goes straight through on one of its ways.
constexpr int kMostWalls = 32;

}  // namespace

/// Emissive surfaces as a point sees them on its viewer's side and behind it.
struct Paths::Sides {
  Sides(const AreaLights& lights, const SurfacePoint& point, float time)
      : normal(point.normal),
        front(lights, point.position, normal, time),
        behind(lights, point.position, -normal, time) {}
  AreaLights::View& of(Vec3d direction) { return dot(normal, direction) > 0 ? front : behind; }

  Vec3d normal;
  AreaLights::View front, behind;
};

Paths::Paths(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
             double cone_spread, const PathOptions& options)
    : points_(shot, looks),
      lights_(shot, looks, sky),
      shadows_(looks, points_, std::move(scene)),
      direct_(lights_, shadows_, Glass::bends),
      cone_spread_(cone_spread),
      options_(options),
      has_one_sided_(
          std::any_of(shot.meshes.begin(), shot.meshes.end(), [](const Mesh& mesh) { return mesh.one_sided; })) {}

void Paths::resting_light(const ShadingQuery& query, std::vector<RestingLight>& lights) const {
  add_resting_light(query, points_, direct_, lights);
}

void Paths::radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const {
  shade_together(
      queries, colours, points_, direct_, true,
      [&](const ShadingQuery& query, const SurfacePoint& point, const Scattering& scatter, Vec3f punctual,
          const SampleInstant& instant) { return trace(query.ray, point, scatter, punctual, instant, query.key); });
}

void Paths::own_light(std::span<const ShadingQuery> queries, bool share_asked,
                      std::span<SharedSurface> surfaces) const {
  visit_together(queries, points_, direct_, !share_asked,
                 [&](size_t i, const SurfacePoint& point, const Scattering& scatter, Vec3f punctual,
                     const SampleInstant& instant) {
                   SharedSurface& surface = surfaces[i];
                   surface = {point.look.emission + punctual, {}, point.weights, point.entering};
                   if (is_lit(point) && scatter.is_broad()) {
                     surface.reflects = scatter.reflects();
                   } else {
                     if (share_asked) punctual = punctual_at(point, scatter, instant);
                     surface.own = trace(queries[i].ray, point, scatter, punctual, instant, queries[i].key);
                   }
                   if (!is_finite(surface.own)) surface.own = {};
                 });
}

void Paths::shared_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<Vec3f> colours) const {
  shade_together(queries, colours, points_, direct_, share_asked,
                 [&](const ShadingQuery& query, SurfacePoint point, const Scattering& scatter, Vec3f punctual,
                     const SampleInstant& instant) {
                   point.look.emission = {};
                   return trace(query.ray, point, scatter, punctual, instant, query.key);
                 });
}

bool Paths::passes(const SurfacePoint& point, SampleKey key, Vec3f& weight) {
  const Vec3f share = straight_share(point);
  const float chance = std::min(largest(share), 1.0f);
  if (!(chance > 0)) return false;
  if (light_point(key)[0] < chance) {
    weight = weight * share / chance;
    return true;
  }
  weight = weight / (1 - chance);
  return false;
}

std::optional<SurfacePoint> Paths::next(Ray ray, double width, const SampleInstant& instant, SampleKey key,
                                        Vec3f& weight) const {
  for (int pane = 0; pane < kMostWalls; ++pane) {
    const auto hit = shadows_.scene().intersect(ray, instant.time);
    if (!hit) return std::nullopt;
    width += cone_spread_ * static_cast<double>(hit->dist);
    const SurfacePoint point = points_.at(ray, hit->mesh, hit->triangle, width, instant);
    key = key.branch(kPassBranch);
    if (!passes(point, key, weight)) return point;
    ray = point.ray(to_double(ray.direction), -1);
  }
  weight = {};
  return std::nullopt;
}

Vec3f Paths::found(const SurfacePoint& point, const Scattering& scatter, const SampleInstant& instant, Sides& sides,
                   SampleKey key) const {
  if (scatter.is_dark()) return {};
  Vec3f sum = direct_.by_choice(point, scatter, instant, sides.front, key);
  if (scatter.lets_through())
    sum += direct_.on_side(point, -point.normal, scatter, instant, sides.behind, key.branch(kBehindBranch));
  return sum;
}

Vec3f Paths::from_sky(const Sample& sample, const SampleInstant& instant) const {
  const Vec3d in_world = instant.place.vector_to_world(sample.direction);
  if (sample.is_sharp()) return lights_.beyond(in_world, cone_spread_);
  Vec3f sum = lights_.environment();
  if (!lights_.sky().empty()) {
    const double others = lights_.sky().density(in_world);
    sum += lights_.sky().radiance(in_world) * static_cast<float>(sample.density / (sample.density + others));
  }
  return sum;
}

Vec3f Paths::from_surface(const Sample& sample, const SurfacePoint& met, const SurfacePoint& from, Sides& sides) const {
  if (met.face == Vec3d{}) return {};
  if (met.material->unlit) return sample.is_sharp() ? met.look.base_colour : Vec3f{};
  if (sample.is_sharp() || met.look.emission == Vec3f{}) return met.look.emission;
  AreaLights::View& view = sides.of(sample.direction);
  const auto light = view.met(met.mesh, met.triangle, sample.direction, length(met.position - from.position));
  if (!light) return view.holds(met.mesh) ? Vec3f{} : met.look.emission;
  return met.look.emission * static_cast<float>(sample.density / (sample.density + light->density));
}

Vec3f Paths::from_light(const Sample& sample, const SurfacePoint& from, const SampleInstant& instant,
                        Sides& sides) const {
  const auto there = shadows_.look(from, sample.direction, instant, Glass::bends);
  if (!there) return {};
  if (!there->hit) return from_sky(sample, instant) * there->open;
  const auto light =
      sides.of(sample.direction)
          .met(there->hit->mesh, there->hit->triangle, sample.direction, static_cast<double>(there->hit->dist));
  if (!light) return {};
  return light->radiance * there->open * static_cast<float>(sample.density / (sample.density + light->density));
}

Vec3f Paths::punctual_at(const SurfacePoint& point, const Scattering& scatter, const SampleInstant& instant) const {
  Vec3f sum{};
  direct_.add_asked({&point, 1}, {&scatter, 1}, {&instant, 1}, {&sum, 1});
  return sum;
}

Vec3f Paths::trace(const Ray& ray, const SurfacePoint& first, const Scattering& first_scatter, Vec3f punctual,
                   const SampleInstant& instant, SampleKey key) const {
  if (first.face == Vec3d{}) return {};
  if (first.material->unlit) return first.look.base_colour;
  Vec3f weight{1, 1, 1};
  const SurfacePoint* point = &first;
  const Scattering* scatter = &first_scatter;
  std::optional<SurfacePoint> own_point;
  std::optional<Scattering> own_scatter;
  const auto move_to = [&](const SurfacePoint& met) {
    point = &own_point.emplace(met);
    scatter = &own_scatter.emplace(*point);
    punctual = punctual_at(*point, *scatter, instant);
  };
  Vec3f direct = first.look.emission, bounced{};
  if (passes(first, key.branch(kPassBranch), weight)) {
    const Vec3d along = normalize(to_double(ray.direction));
    const auto met = next(first.ray(along, -1), first.width, instant, key.branch(kPassBranch), weight);
    if (!met) return direct + weight * lights_.beyond(instant.place.vector_to_world(along), cone_spread_);
    direct += weight * (met->material->unlit ? met->look.base_colour : met->look.emission);
    if (!is_lit(*met)) return direct;
    move_to(*met);
  }
  for (int depth = 0;; ++depth) {
    const bool is_last = depth >= options_.max_depth;
    Vec3f& sum = depth == 0 ? direct : bounced;
    Sides sides(lights_.areas(), *point, instant.time);
    sum += weight * (punctual + found(*point, *scatter, instant, sides, key));
    const auto sample = scatter->sample(light_point(key.branch(kWayBranch)));
    if (!sample || (sample->is_sharp() && is_last)) break;
    weight = weight * sample->weight;
    const bool light_goes_apart = has_one_sided_ && !sample->is_sharp();
    if (light_goes_apart) sum += weight * from_light(*sample, *point, instant, sides);
    if (light_goes_apart && is_last) break;
    if (depth >= kSureBounces) {
      const float chance = std::min(largest(weight), 1.0f);
      if (!(unit_float(hash(key.seed, key.index, kRouletteDimension)) < chance)) break;
      weight = weight / chance;
    }
    key = key.branch(kBounceBranch);
    const Ray away = point->ray(sample->direction, point->side_of(sample->direction));
    const auto met = next(away, point->width, instant, key, weight);
    if (!met) {
      if (!light_goes_apart) sum += weight * from_sky(*sample, instant);
      break;
    }
    if (!light_goes_apart || !sides.front.holds(met->mesh)) sum += weight * from_surface(*sample, *met, *point, sides);
    if (is_last || !is_lit(*met)) break;
    move_to(*met);
  }
  if (options_.clamp > 0 && largest(bounced) > options_.clamp) bounced = bounced * (options_.clamp / largest(bounced));
  return direct + bounced;
}

}  // namespace kairos
