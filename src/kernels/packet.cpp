#include "kernels/packet.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

/// Rays that lean apart by more than this see different things; what they would share does not pay.
constexpr float kWidestLean = 0.25f;
/// More than the rounding errors of a lean's computation, as a share of it and of the shear.
constexpr float kLeanError = 1e-5f, kShearError = 0x1p-22f;

}  // namespace

std::optional<RayPacket> make_packet(std::span<const Ray> rays) {
  RayPacket packet;
  packet.rays = rays;
  packet.origin = rays[0].origin;
  const Vec3f first = rays[0].direction;
  const float ax = std::abs(first.x), ay = std::abs(first.y), az = std::abs(first.z);
  packet.kw = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
  packet.ku = (packet.kw + 1) % 3;
  packet.kv = (packet.kw + 2) % 3;
  if (first[packet.kw] < 0) {
    std::swap(packet.ku, packet.kv);
    packet.ahead = -1;
  }
  for (int k = 0; k < 3; ++k) packet.direction_low[k] = packet.direction_high[k] = first[k];
  for (const Ray& ray : rays) {
    if (ray.origin != packet.origin) return std::nullopt;
    for (int k = 0; k < 3; ++k) {
      packet.direction_low[k] = std::min(packet.direction_low[k], ray.direction[k]);
      packet.direction_high[k] = std::max(packet.direction_high[k], ray.direction[k]);
    }
  }
  for (int k = 0; k < 3; ++k)
    if (!(packet.direction_low[k] > 0) && !(packet.direction_high[k] < 0)) return std::nullopt;

  // Slopes against the depth axis of every ray, then the middle of them.
  float slope_u[kPacketLanes], slope_v[kPacketLanes];
  for (size_t i = 0; i < rays.size(); ++i) {
    const Vec3f& d = rays[i].direction;
    slope_u[i] = d[packet.ku] / d[packet.kw];
    slope_v[i] = d[packet.kv] / d[packet.kw];
  }
  const auto [low_u, high_u] = std::minmax_element(slope_u, slope_u + rays.size());
  const auto [low_v, high_v] = std::minmax_element(slope_v, slope_v + rays.size());
  if (!(*high_u - *low_u < kWidestLean) || !(*high_v - *low_v < kWidestLean)) return std::nullopt;
  packet.shear_u = *low_u + (*high_u - *low_u) / 2;
  packet.shear_v = *low_v + (*high_v - *low_v) / 2;

  packet.rays_per_register = rays.size() > kPacketLanes / 4 ? kPacketLanes : kPacketLanes / 4;
  packet.least_dist_per_depth = std::abs(1 / first[packet.kw]);
  for (size_t lane = 0; lane < kPacketLanes; ++lane) {
    const size_t ray = std::min(packet.ray_of(lane), rays.size() - 1);  // lanes without a ray repeat the last one
    packet.lean_u[lane] = (slope_u[ray] - packet.shear_u) * packet.ahead;
    packet.lean_v[lane] = (slope_v[ray] - packet.shear_v) * packet.ahead;
    packet.dist_per_depth[lane] = std::abs(1 / rays[ray].direction[packet.kw]);
    packet.widest_u = std::max(packet.widest_u, std::abs(packet.lean_u[lane]));
    packet.widest_v = std::max(packet.widest_v, std::abs(packet.lean_v[lane]));
    packet.least_dist_per_depth = std::min(packet.least_dist_per_depth, packet.dist_per_depth[lane]);
  }
  packet.widest_u += kLeanError * packet.widest_u + kShearError * std::abs(packet.shear_u);
  packet.widest_v += kLeanError * packet.widest_v + kShearError * std::abs(packet.shear_v);
  return packet;
}

}  // namespace kairos
