#include "shading/shadow_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shading/reflectance.h"

namespace kairos {

namespace {

// Shadow rays end this part of their length before the light's surface, so as not to meet it.
constexpr double kShadowEnd = 1 - 0x1p-16;
// How many panes of glass a shadow ray goes through, and what is too little light to go on.
constexpr int kMostPanes = 32;
constexpr float kDark = 1.0f / 512;
constexpr size_t kTogether = 64;

}  // namespace

std::vector<bool> panes_of(const Shot& shot) {
  std::vector<bool> panes;
  for (const Mesh& mesh : shot.meshes)
    panes.push_back(mesh.material < shot.materials.size() && shot.materials[mesh.material].transmission > 0);
  return panes;
}

ShadowRays::Way ShadowRays::way_from(const SurfacePoint& point, Vec3d direction, double dist) {
  const double side = point.side_of(direction);
  if (!std::isfinite(dist)) return {point.ray(direction, side), dist};
  // Aimed at the same place from where it starts: along a parallel it would meet a light's surface too soon where that
  // lies at a grazing angle.
  const Vec3d off = point.face * (side * point.offset), there = direction * dist - off;
  const double length_there = length(there);
  return {{to_float(point.position + off), to_float(there * (1 / length_there))},
          length_there * kShadowEnd - point.offset};
}

Vec3f ShadowRays::open(const SurfacePoint& point, Vec3d direction, double dist, const SampleInstant& instant,
                       Glass glass) const {
  const Way way = way_from(point, direction, dist);
  if (scene_->occluded(way.ray, instant.time, static_cast<float>(way.dist))) return {};
  return scene_->has_panes() ? through_panes(way, point.width, instant, glass) : Vec3f{1, 1, 1};
}

void ShadowRays::open(std::span<const Query> queries, std::span<Vec3f> result) const {
  std::array<Way, kTogether> ways{};
  std::array<Ray, kTogether> rays;
  std::array<float, kTogether> times{}, dists{};
  std::array<bool, kTogether> blocked{};
  for (size_t begin = 0; begin < queries.size(); begin += kTogether) {
    const size_t count = std::min(kTogether, queries.size() - begin);
    for (size_t i = 0; i < count; ++i) {
      const Query& query = queries[begin + i];
      dists[i] = 0;
      if (!(query.dist > 0)) continue;
      ways[i] = way_from(*query.point, query.direction, query.dist);
      rays[i] = ways[i].ray;
      times[i] = query.instant->time;
      dists[i] = static_cast<float>(ways[i].dist);
    }
    const auto first = [&](auto& all) { return std::span(all).first(count); };
    for (const DiscreteLayer layer : {DiscreteLayer::all, DiscreteLayer::still}) {
      std::array<float, kTogether> asked{};
      std::array<bool, kTogether> hit{};
      bool any = false;
      for (size_t i = 0; i < count; ++i)
        if (queries[begin + i].layer == layer && dists[i] > 0) {
          asked[i] = dists[i];
          any = true;
        }
      if (!any) continue;
      scene_->occluded(first(rays), first(times), first(asked), first(hit), layer);
      for (size_t i = 0; i < count; ++i) blocked[i] = blocked[i] || hit[i];
    }
    for (size_t i = 0; i < count; ++i) {
      const Query& query = queries[begin + i];
      Vec3f& open = result[begin + i];
      if (!(query.dist > 0) || blocked[i])
        open = {};
      else if (scene_->has_panes())
        open = through_panes(ways[i], query.point->width, *query.instant);
      else
        open = {1, 1, 1};
    }
  }
}

Vec3f ShadowRays::through(const SurfacePoint& glass) const {
  // As if it entered at every face: light that comes through bent is not lost at the far side.
  const double cosine = std::clamp(dot(glass.normal, glass.to_viewer), 0.0, 1.0);
  return reflectance(*glass.material, glass.look, cosine, true).through;
}

Vec3f ShadowRays::through_panes(Way way, double width, const SampleInstant& instant, Glass glass) const {
  Vec3f open{1, 1, 1};
  for (int passed_panes = 0; passed_panes < kMostPanes; ++passed_panes) {
    if (!(way.dist > 0)) return open;
    const auto hit = scene_->intersect_panes(way.ray, instant.time, static_cast<float>(way.dist));
    if (!hit) return open;
    const SurfacePoint pane = points_.at(way.ray, hit->mesh, hit->triangle, width, instant);
    if (glass == Glass::bends && !is_straight(*pane.material, pane.look)) return {};
    open = open * through(pane);
    if (largest(open) < kDark) return {};
    way = way_from(pane, to_double(way.ray.direction), way.dist - static_cast<double>(hit->dist));
  }
  return {};
}

std::optional<BeyondPanes> ShadowRays::look(const SurfacePoint& point, Vec3d direction, const SampleInstant& instant,
                                            Glass glass) const {
  BeyondPanes result{{}, {1, 1, 1}};
  Ray ray = point.ray(direction, point.side_of(direction));
  double passed = point.offset;
  for (int passed_panes = 0; passed_panes < kMostPanes; ++passed_panes) {
    result.hit = scene_->intersect(ray, instant.time, std::numeric_limits<float>::infinity(), Facing::far_end);
    if (!result.hit) return result;
    if (!(looks_.material(result.hit->mesh).transmission > 0)) {
      result.hit->dist += static_cast<float>(passed);
      return result;
    }
    const SurfacePoint pane = points_.at(ray, result.hit->mesh, result.hit->triangle, point.width, instant);
    if (glass == Glass::bends && !is_straight(*pane.material, pane.look)) return std::nullopt;
    result.open = result.open * through(pane);
    if (largest(result.open) < kDark) return std::nullopt;
    passed += static_cast<double>(result.hit->dist) + 2 * pane.offset;
    ray = pane.ray(direction, -1);
  }
  return std::nullopt;
}

}  // namespace kairos
