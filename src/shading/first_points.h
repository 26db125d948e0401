// What the first surfaces that rays from the camera see have in common to be shaded: several at a time.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "shading/direct_light.h"
#include "shading/lit_shading.h"
#include "shading/surface_point.h"

namespace kairos {

/// Are surfaces with this point lit at all? Those without area and those that show their own colour in any light are
/// not.
inline bool is_lit(const SurfacePoint& point) { return point.face != Vec3d{} && !point.material->unlit; }

/// Calls use(number, point, scatter, punctual, instant) for each query. Scatter: see DirectLight; made of a point.
/// punctual: what point, spot and directional lights that are each asked bring, whose shadow rays have gone through the
/// scene together; zero unless with_asked.
template <class Scatter, class Use>
void visit_together(std::span<const ShadingQuery> queries, const SurfacePoints& surfaces,
                    const DirectLight<Scatter>& direct, bool with_asked, const Use& use) {
  constexpr size_t kQueriesAtOnce = 64;
  std::vector<SampleInstant> instants;
  std::vector<SurfacePoint> points;
  std::vector<Scatter> scatters;
  points.reserve(std::min(queries.size(), kQueriesAtOnce));  // scatters may point to them
  std::vector<Vec3f> punctual(std::min(queries.size(), kQueriesAtOnce));
  for (size_t begin = 0; begin < queries.size(); begin += kQueriesAtOnce) {
    const auto some = queries.subspan(begin, std::min(kQueriesAtOnce, queries.size() - begin));
    instants.clear();
    points.clear();
    scatters.clear();
    for (const ShadingQuery& query : some) {
      instants.push_back(surfaces.instant(query.time));
      points.push_back(surfaces.at(query.ray, query.mesh, query.triangle, query.width, instants.back()));
      scatters.emplace_back(points.back());
    }
    std::fill(punctual.begin(), punctual.end(), Vec3f{});
    if (with_asked) direct.add_asked(points, scatters, instants, std::span(punctual).first(some.size()), some);
    for (size_t i = 0; i < some.size(); ++i) use(begin + i, points[i], scatters[i], punctual[i], instants[i]);
  }
}

/// Keeps what colour_of(query, point, scatter, punctual, instant) returns for each query, if that is finite.
template <class Scatter, class ColourOf>
void shade_together(std::span<const ShadingQuery> queries, std::span<Vec3f> colours, const SurfacePoints& surfaces,
                    const DirectLight<Scatter>& direct, bool with_asked, const ColourOf& colour_of) {
  visit_together(
      queries, surfaces, direct, with_asked,
      [&](size_t i, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual, const SampleInstant& instant) {
        const Vec3f colour = colour_of(queries[i], point, scatter, punctual, instant);
        colours[i] = is_finite(colour) ? colour : Vec3f{};
      });
}

/// What a query sees, and what resting lights bring there.
template <class Scatter>
void add_resting_light(const ShadingQuery& query, const SurfacePoints& surfaces, const DirectLight<Scatter>& direct,
                       std::vector<RestingLight>& lights) {
  const SampleInstant instant = surfaces.instant(query.time);
  const SurfacePoint point = surfaces.at(query.ray, query.mesh, query.triangle, query.width, instant);
  if (is_lit(point)) direct.add_resting(point, Scatter(point), instant, lights);
}

}  // namespace kairos
