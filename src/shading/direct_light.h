// Light that arrives at a surface straight from lights, by looking for it there.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "shading/light_points.h"
#include "shading/lights.h"
#include "shading/lit_shading.h"
#include "shading/shadow_rays.h"
#include "shading/surface_point.h"

namespace kairos {

/// What is looked for towards lights, in random directions of their choosing. Who also looks where the surface scatters
/// to weighs both by the balance heuristic: E. Veach and L. Guibas, Optimally Combining Sampling Techniques, 1995.
///
/// A Scatter says how a surface scatters at a point:
///   Vec3f value(Vec3d direction) const: of light from there, times the cosine; zero for what does not arrive;
///   double area_density(Vec3d direction) const, sky_density(Vec3d direction) const: per steradian, of being looked at
///   by
///     scattering, where emissive surfaces and where the sky are taken in that way; 0 where they are not;
///   bool is_dark() const: nothing scatters, so that nobody need ask.
template <class Scatter>
class DirectLight {
 public:
  /// glass: on the way to emissive surfaces and the sky. Light of point, spot and directional lights, which nothing can
  /// meet, goes straight through all of it.
  DirectLight(const Lights& lights, const ShadowRays& shadows, Glass glass = Glass::straight)
      : lights_(lights), shadows_(shadows), glass_(glass) {}

  /// One of many punctual lights, a place on emissive meshes, a direction of the sky. view: of the point; of no use
  /// where there are no emissive meshes.
  Vec3f by_choice(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                  AreaLights::View& view, SampleKey key) const {
    return by_choice(point, scatter, instant, view, key, tracing(point, instant));
  }
  /// What comes in does arrive(value, direction, dist, glass): the Vec3f that it returns is what arrives.
  template <class Arrive>
  Vec3f by_choice(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                  AreaLights::View& view, SampleKey key, const Arrive& arrive) const {
    Vec3f sum = on_side(point, point.normal, scatter, instant, view, key, arrive);
    if (!lights_.sky().empty()) {
      if (const auto bright = lights_.sky().sample(light_point(key.branch(kSkyBranch)))) {
        const Vec3d direction = instant.place.vector_from_world(*bright);
        sum += from_sky(scatter, direction, instant, arrive);
      }
    }
    return sum;
  }

  /// The first two of these on one side of the surface. side: the point's normal or its opposite; view: with it.
  Vec3f on_side(const SurfacePoint& point, Vec3d side, const Scatter& scatter, const SampleInstant& instant,
                AreaLights::View& view, SampleKey key) const {
    return on_side(point, side, scatter, instant, view, key, tracing(point, instant));
  }
  template <class Arrive>
  Vec3f on_side(const SurfacePoint& point, Vec3d side, const Scatter& scatter, const SampleInstant& instant,
                AreaLights::View& view, SampleKey key, const Arrive& arrive) const {
    Vec3f sum{};
    if (lights_.has_many()) {
      const float u = light_point(key.branch(kManyBranch))[0];
      const auto light = lights_.one_of_many(point.position, side, instant.time, instant.place, u);
      if (light && dot(side, light->direction) > 0)
        sum +=
            arrive(scatter.value(light->direction) * light->irradiance, light->direction, light->dist, Glass::straight);
    }
    if (!lights_.areas().empty()) {
      const auto light = view.sample(light_point(key.branch(kAreaBranch)));
      if (light && dot(side, light->direction) > 0) {
        const double density = light->density + (light->is_met ? scatter.area_density(light->direction) : 0);
        const Vec3f value = scatter.value(light->direction) * light->radiance * static_cast<float>(1 / density);
        sum += arrive(value, light->direction, light->dist, glass_);
      }
    }
    return sum;
  }

  /// From the sky's pictures in a direction, weighed as one that either of two ways may have chosen.
  Vec3f from_sky(const SurfacePoint& point, const Scatter& scatter, Vec3d direction,
                 const SampleInstant& instant) const {
    return from_sky(scatter, direction, instant, tracing(point, instant));
  }
  template <class Arrive>
  Vec3f from_sky(const Scatter& scatter, Vec3d direction, const SampleInstant& instant, const Arrive& arrive) const {
    const Vec3d in_world = instant.place.vector_to_world(direction);
    const double density = lights_.sky().density(in_world) + scatter.sky_density(direction);
    if (!(density > 0)) return {};
    const Vec3f value = scatter.value(direction) * lights_.sky().radiance(in_world) * static_cast<float>(1 / density);
    return arrive(value, direction, std::numeric_limits<double>::infinity(), glass_);
  }

  /// Of each of the lights that add_asked() asks and that stand still.
  void add_resting(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                   std::vector<RestingLight>& out) const {
    if (scatter.is_dark()) return;
    for (size_t light = 0; light < lights_.punctual_count(); ++light) {
      if (!lights_.rests(light)) continue;
      const auto from = lights_.punctual(light, point.position, instant.time, instant.place);
      if (from) collecting(point, out)(scatter.value(from->direction) * from->irradiance, from->direction, from->dist);
    }
  }

  /// What by_choice() and its like need to trace shadow rays.
  auto tracing(const SurfacePoint& point, const SampleInstant& instant) const {
    return [&](Vec3f value, Vec3d direction, double dist, Glass glass) {
      if (value == Vec3f{} || !is_finite(value)) return Vec3f{};
      return value * shadows_.open(point, direction, dist, instant, glass);
    };
  }
  /// What they need to note the ways of light instead.
  static auto collecting(const SurfacePoint& point, std::vector<RestingLight>& out) {
    return [&](Vec3f value, Vec3d direction, double dist, Glass /*glass*/ = Glass::straight) {
      if (value == Vec3f{} || !is_finite(value)) return Vec3f{};
      const ShadowRays::Way way = ShadowRays::way_from(point, direction, dist);
      out.push_back({way.ray, static_cast<float>(way.dist), value});
      return Vec3f{};
    };
  }

  /// Adds to `sums` what all those point, spot and directional lights bring that are each asked; those that stand still
  /// as the queries want it. All spans of one length; shadow rays to a light go through the scene together.
  void add_asked(std::span<const SurfacePoint> points, std::span<const Scatter> scatters,
                 std::span<const SampleInstant> instants, std::span<Vec3f> sums,
                 std::span<const ShadingQuery> wanted = {}) const {
    for (size_t begin = 0; begin < points.size(); begin += kTogether) {
      const size_t count = std::min(kTogether, points.size() - begin);
      std::array<ShadowRays::Query, kTogether> queries;
      std::array<Vec3f, kTogether> values, open;
      for (size_t light = 0; light < lights_.punctual_count(); ++light) {
        bool any = false;
        for (size_t i = 0; i < count; ++i) {
          const SurfacePoint& point = points[begin + i];
          const SampleInstant& instant = instants[begin + i];
          const bool rests = !wanted.empty() && lights_.rests(light);
          const RestingLights resting = rests ? wanted[begin + i].resting : RestingLights::as_is;
          const bool none_passes = resting == RestingLights::as_if_none_passed;
          queries[i] = {&point, &instant, {}, 0, none_passes ? DiscreteLayer::still : DiscreteLayer::all};
          values[i] = {};
          if (scatters[begin + i].is_dark() || resting == RestingLights::left_out) continue;
          const auto from = lights_.punctual(light, point.position, instant.time, instant.place);
          if (from) values[i] = scatters[begin + i].value(from->direction) * from->irradiance;
          if (values[i] == Vec3f{}) continue;
          queries[i].direction = from->direction;
          queries[i].dist = from->dist;
          any = true;
        }
        if (!any) continue;
        shadows_.open(std::span(queries).first(count), std::span(open).first(count));
        for (size_t i = 0; i < count; ++i)
          if (queries[i].dist > 0) sums[begin + i] += values[i] * open[i];
      }
    }
  }

 private:
  // Branches of a sample's key.
  static constexpr uint64_t kAreaBranch = 11, kSkyBranch = 15, kManyBranch = 17;
  static constexpr size_t kTogether = 64;

  const Lights& lights_;
  const ShadowRays& shadows_;
  Glass glass_;
};

}  // namespace kairos
