// How discrete rays go through Embree's scenes, alone and in packets.
#include <algorithm>
#include <array>
#include <limits>

#include "discrete/discrete_impl.h"

namespace kairos {

namespace {

/// Rays that go through the scene together. Sixteen are faster by up to a fifth where they stay together (the fan, the
/// hall) and as fast where they don't; of fewer than nine, half of the lanes would be empty.
constexpr size_t kLargePacket = 16, kSmallPacket = 8;

/// Rays begin beyond their origin: a surface in which the eye lies is seen by none, as by no time-continuous one.
constexpr float kNearest = std::numeric_limits<float>::min();

struct LargePacket {
  static constexpr size_t kSize = kLargePacket;
  using Query = RTCRayHit16;
  static constexpr auto kIntersect = rtcIntersect16;
  using ShadowQuery = RTCRay16;
  static constexpr auto kOccluded = rtcOccluded16;
};
struct SmallPacket {
  static constexpr size_t kSize = kSmallPacket;
  using Query = RTCRayHit8;
  static constexpr auto kIntersect = rtcIntersect8;
  using ShadowQuery = RTCRay8;
  static constexpr auto kOccluded = rtcOccluded8;
};

/// Of one ray, into Embree's.
void fill(RTCRay& query, const Ray& ray, float max_dist) {
  query.org_x = ray.origin.x;
  query.org_y = ray.origin.y;
  query.org_z = ray.origin.z;
  query.dir_x = ray.direction.x;
  query.dir_y = ray.direction.y;
  query.dir_z = ray.direction.z;
  query.tnear = kNearest;
  query.tfar = max_dist;
  query.mask = ~0u;
}
/// The same into number `i` of a packet.
template <class Packet>
void fill(Packet& query, size_t i, const Ray& ray, float max_dist) {
  query.org_x[i] = ray.origin.x;
  query.org_y[i] = ray.origin.y;
  query.org_z[i] = ray.origin.z;
  query.dir_x[i] = ray.direction.x;
  query.dir_y[i] = ray.direction.y;
  query.dir_z[i] = ray.direction.z;
  query.tnear[i] = kNearest;
  query.tfar[i] = max_dist;
  query.mask[i] = ~0u;
  query.id[i] = static_cast<unsigned>(i);
}

bool usable(const Ray& ray, float time) {
  return is_finite(ray.origin) && is_finite(ray.direction) && !(ray.direction == Vec3f{}) && time >= 0 && time <= 1;
}

DiscreteContext context_of(const Ray* rays, const float* times, Facing facing) {
  DiscreteContext context{{}, rays, times, facing};
  rtcInitIntersectContext(&context.embree);
  return context;
}

}  // namespace

std::optional<DiscreteHit> DiscreteScene::Impl::intersect(const Ray& ray, float time, float max_dist,
                                                          Facing facing) const {
  if (!usable(ray, time) || !(max_dist > 0)) return std::nullopt;
  RTCRayHit query{};
  fill(query.ray, ray, max_dist);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  DiscreteContext context = context_of(&ray, &time, facing);
  float hit_time = 0;                             // in its window
  for (const DiscreteWindow& window : windows) {  // each looks no farther than what the ones before have hit
    if (!window.holds(time)) continue;
    query.ray.time = window.local(time);
    const float farthest = query.ray.tfar;
    rtcIntersect1(window.scene.get(), &context.embree, &query);
    if (query.ray.tfar < farthest) hit_time = query.ray.time;
  }
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const unsigned instance = query.hit.instID[0];
  const Vec3f normal = normal_of_hit({query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}, instance, hit_time);
  return DiscreteHit{query.ray.tfar, mesh_of_hit(query.hit.geomID, instance), query.hit.primID, query.hit.u,
                     query.hit.v,    faces_ray(normal, ray.direction)};
}

bool DiscreteScene::Impl::occluded(const Ray& ray, float time, float max_dist, DiscreteLayer layer) const {
  if (!usable(ray, time) || !(max_dist > 0)) return false;
  RTCRay query{};
  DiscreteContext context = context_of(&ray, &time, Facing::far_end);
  for (const DiscreteWindow& window : windows) {
    if (!window.is_in(layer) || !window.holds(time)) continue;
    fill(query, ray, max_dist);
    query.time = window.local(time);
    rtcOccluded1(window.scene.get(), &context.embree, &query);
    if (query.tfar < 0) return true;
  }
  return false;
}

template <class Packet>
void DiscreteScene::Impl::occluded_packet(std::span<const Ray> rays, std::span<const float> times,
                                          std::span<const float> max_dists, std::span<bool> result,
                                          DiscreteLayer layer) const {
  typename Packet::ShadowQuery query{};
  for (size_t i = 0; i < rays.size(); ++i) {
    fill(query, i, rays[i], max_dists[i]);
    result[i] = false;
  }
  DiscreteContext context = context_of(rays.data(), times.data(), Facing::far_end);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (const DiscreteWindow& window : windows) {
    if (!window.is_in(layer)) continue;
    alignas(64) int valid[Packet::kSize]{};
    bool any = false;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (result[i] || !usable(rays[i], times[i]) || !(max_dists[i] > 0) || !window.holds(times[i])) continue;
      valid[i] = -1;
      any = true;
      query.time[i] = window.local(times[i]);
    }
    if (!any) continue;
    Packet::kOccluded(valid, window.scene.get(), &context.embree, &query);
    for (size_t i = 0; i < rays.size(); ++i) result[i] = result[i] || (valid[i] == -1 && query.tfar[i] < 0);
  }
}

template <class Packet>
void DiscreteScene::Impl::intersect_packet(std::span<const Ray> rays, std::span<const float> times,
                                           std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
  typename Packet::Query query{};
  for (size_t i = 0; i < rays.size(); ++i) fill(query.ray, i, rays[i], std::numeric_limits<float>::infinity());
  std::fill(std::begin(query.hit.geomID), std::end(query.hit.geomID), RTC_INVALID_GEOMETRY_ID);
  std::fill(std::begin(query.hit.instID[0]), std::end(query.hit.instID[0]), RTC_INVALID_GEOMETRY_ID);
  std::array<float, Packet::kSize> hit_times{};  // in their windows
  DiscreteContext context = context_of(rays.data(), times.data(), Facing::origin);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (const DiscreteWindow& window : windows) {
    if (!window.is_in(layer)) continue;
    alignas(64) int valid[Packet::kSize]{};
    bool any = false;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!usable(rays[i], times[i]) || !window.holds(times[i])) continue;
      valid[i] = -1;
      any = true;
      query.ray.time[i] = window.local(times[i]);
    }
    if (!any) continue;
    std::array<float, Packet::kSize> farthest;
    std::copy_n(query.ray.tfar, Packet::kSize, farthest.begin());
    Packet::kIntersect(valid, window.scene.get(), &context.embree, &query);
    if (placed.empty()) continue;
    for (size_t i = 0; i < rays.size(); ++i)
      if (query.ray.tfar[i] < farthest[i]) hit_times[i] = query.ray.time[i];
  }
  for (size_t i = 0; i < rays.size(); ++i) {
    hits[i].reset();
    const uint32_t geometry = query.hit.geomID[i];
    if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
    const unsigned instance = query.hit.instID[0][i];
    const Vec3f normal =
        normal_of_hit({query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]}, instance, hit_times[i]);
    hits[i] = DiscreteHit{query.ray.tfar[i], mesh_of_hit(geometry, instance),     query.hit.primID[i], query.hit.u[i],
                          query.hit.v[i],    faces_ray(normal, rays[i].direction)};
  }
}

void DiscreteScene::Impl::intersect_all(std::span<const Ray> rays, std::span<const float> times,
                                        std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
  const DenormalsAreZero guard;
  for (size_t i = 0; i < rays.size();) {
    const size_t left = rays.size() - i, count = std::min(left, left > kSmallPacket ? kLargePacket : kSmallPacket);
    const auto some_rays = rays.subspan(i, count);
    const auto some_times = times.subspan(i, count);
    const auto some_hits = hits.subspan(i, count);
    if (count > kSmallPacket)
      intersect_packet<LargePacket>(some_rays, some_times, some_hits, layer);
    else
      intersect_packet<SmallPacket>(some_rays, some_times, some_hits, layer);
    i += count;
  }
}

void DiscreteScene::Impl::occluded_all(std::span<const Ray> rays, std::span<const float> times,
                                       std::span<const float> max_dists, std::span<bool> result,
                                       DiscreteLayer layer) const {
  const DenormalsAreZero guard;
  for (size_t i = 0; i < rays.size();) {
    const size_t left = rays.size() - i, count = std::min(left, left > kSmallPacket ? kLargePacket : kSmallPacket);
    const auto take = [&](auto whole) { return whole.subspan(i, count); };
    if (left == 1)
      result[i] = occluded(rays[i], times[i], max_dists[i], layer);
    else if (count > kSmallPacket)
      occluded_packet<LargePacket>(take(rays), take(times), take(max_dists), take(result), layer);
    else
      occluded_packet<SmallPacket>(take(rays), take(times), take(max_dists), take(result), layer);
    i += count;
  }
}

}  // namespace kairos
