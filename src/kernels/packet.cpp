#include "kernels/packet.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

/// Rays that lean apart by more than this see different things; what they would share does not pay.
constexpr float kWidestLean = 0.25f;
/// More than the rounding errors of a lean's computation, as a share of it and of the shear.
constexpr float kLeanError = 1e-5f, kShearError = 0x1p-22f;
/// More than those of how far parallel rays are from each other.
constexpr double kApartError = 0x1p-20;

/// The axis along which the first ray's depth is measured, and the other two.
void choose_axes(RayPacket& packet) {
  const Vec3f first = packet.rays[0].direction;
  const float ax = std::abs(first.x), ay = std::abs(first.y), az = std::abs(first.z);
  packet.kw = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
  packet.ku = (packet.kw + 1) % 3;
  packet.kv = (packet.kw + 2) % 3;
  if (first[packet.kw] < 0) {
    std::swap(packet.ku, packet.kv);
    packet.ahead = -1;
  }
  packet.rays_per_register = packet.rays.size() > kPacketLanes / 4 ? kPacketLanes : kPacketLanes / 4;
}

/// The ray of a lane: those without one repeat the last.
size_t ray_in(const RayPacket& packet, size_t lane) { return std::min(packet.ray_of(lane), packet.rays.size() - 1); }

/// Rays of one direction, in the plane across it at which the first of them begins.
bool set_parallel(RayPacket& packet, float widest) {
  const Vec3f direction = packet.rays[0].direction;
  const auto& first = *std::min_element(packet.rays.begin(), packet.rays.end(), [&](const Ray& a, const Ray& b) {
    return packet.ahead * a.origin[packet.kw] < packet.ahead * b.origin[packet.kw];
  });
  packet.parallel = true;
  packet.origin = first.origin;
  packet.shear_u = direction[packet.ku] / direction[packet.kw];
  packet.shear_v = direction[packet.kv] / direction[packet.kw];
  packet.least_dist_per_depth = std::abs(1 / direction[packet.kw]);
  double start[kPacketLanes], place[2][kPacketLanes];
  for (size_t i = 0; i < packet.rays.size(); ++i) {
    const Vec3d origin = to_double(packet.rays[i].origin);
    const double along = origin[packet.kw] - static_cast<double>(packet.origin[packet.kw]);
    start[i] = static_cast<double>(packet.ahead) * along;
    place[0][i] = origin[packet.ku] - static_cast<double>(packet.shear_u) * along;
    place[1][i] = origin[packet.kv] - static_cast<double>(packet.shear_v) * along;
  }
  const double last_start = *std::max_element(start, start + packet.rays.size());
  double middle[2];
  for (const size_t side : {size_t{0}, size_t{1}}) {
    const int k = side == 0 ? packet.ku : packet.kv;
    const auto [low, high] = std::minmax_element(place[side], place[side] + packet.rays.size());
    if (!(*high - *low <= static_cast<double>(widest))) return false;
    const double shear = std::abs(static_cast<double>(side == 0 ? packet.shear_u : packet.shear_v));
    const double error = kApartError * ((*high - *low) + shear * last_start);
    packet.origin[k] = static_cast<float>(*low + (*high - *low) / 2);
    middle[side] = static_cast<double>(packet.origin[k]);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    packet.origin_low[k] = std::nextafter(static_cast<float>(*low - error), -kInfinity);
    packet.origin_high[k] = std::nextafter(static_cast<float>(*high + error), kInfinity);
    const double most = std::max(*high - middle[side], middle[side] - *low);
    (side == 0 ? packet.widest_u : packet.widest_v) = static_cast<float>(most + error);
  }
  packet.origin_low[packet.kw] = packet.origin_high[packet.kw] = packet.origin[packet.kw];
  for (int k = 0; k < 3; ++k) packet.direction_low[k] = packet.direction_high[k] = direction[k];
  for (size_t lane = 0; lane < kPacketLanes; ++lane) {
    const size_t ray = ray_in(packet, lane);
    packet.lean_u[lane] = static_cast<float>(place[0][ray] - middle[0]);
    packet.lean_v[lane] = static_cast<float>(place[1][ray] - middle[1]);
    packet.start[lane] = static_cast<float>(start[ray] * static_cast<double>(packet.least_dist_per_depth));
    packet.last_start = std::max(packet.last_start, packet.start[lane]);
    packet.dist_per_depth[lane] = packet.least_dist_per_depth;
  }
  return true;
}

/// Rays of one origin.
bool set_leaning(RayPacket& packet) {
  const auto rays = packet.rays;
  const Vec3f first = rays[0].direction;
  packet.origin = rays[0].origin;
  for (int k = 0; k < 3; ++k) {
    packet.origin_low[k] = packet.origin_high[k] = packet.origin[k];
    packet.direction_low[k] = packet.direction_high[k] = first[k];
  }
  for (const Ray& ray : rays) {
    if (ray.origin != packet.origin) return false;
    for (int k = 0; k < 3; ++k) {
      packet.direction_low[k] = std::min(packet.direction_low[k], ray.direction[k]);
      packet.direction_high[k] = std::max(packet.direction_high[k], ray.direction[k]);
    }
  }
  for (int k = 0; k < 3; ++k)
    if (!(packet.direction_low[k] > 0) && !(packet.direction_high[k] < 0)) return false;

  // Slopes against the depth axis of every ray, then the middle of them.
  float slope_u[kPacketLanes], slope_v[kPacketLanes];
  for (size_t i = 0; i < rays.size(); ++i) {
    const Vec3f& d = rays[i].direction;
    slope_u[i] = d[packet.ku] / d[packet.kw];
    slope_v[i] = d[packet.kv] / d[packet.kw];
  }
  const auto [low_u, high_u] = std::minmax_element(slope_u, slope_u + rays.size());
  const auto [low_v, high_v] = std::minmax_element(slope_v, slope_v + rays.size());
  if (!(*high_u - *low_u < kWidestLean) || !(*high_v - *low_v < kWidestLean)) return false;
  packet.shear_u = *low_u + (*high_u - *low_u) / 2;
  packet.shear_v = *low_v + (*high_v - *low_v) / 2;

  packet.least_dist_per_depth = std::abs(1 / first[packet.kw]);
  for (size_t lane = 0; lane < kPacketLanes; ++lane) {
    const size_t ray = ray_in(packet, lane);
    packet.start[lane] = 0;
    packet.lean_u[lane] = (slope_u[ray] - packet.shear_u) * packet.ahead;
    packet.lean_v[lane] = (slope_v[ray] - packet.shear_v) * packet.ahead;
    packet.dist_per_depth[lane] = std::abs(1 / rays[ray].direction[packet.kw]);
    packet.widest_u = std::max(packet.widest_u, std::abs(packet.lean_u[lane]));
    packet.widest_v = std::max(packet.widest_v, std::abs(packet.lean_v[lane]));
    packet.least_dist_per_depth = std::min(packet.least_dist_per_depth, packet.dist_per_depth[lane]);
  }
  packet.widest_u += kLeanError * packet.widest_u + kShearError * std::abs(packet.shear_u);
  packet.widest_v += kLeanError * packet.widest_v + kShearError * std::abs(packet.shear_v);
  return true;
}

}  // namespace

std::optional<RayPacket> make_packet(std::span<const Ray> rays, float widest) {
  RayPacket packet;
  packet.rays = rays;
  choose_axes(packet);
  const bool parallel =
      std::all_of(rays.begin(), rays.end(), [&](const Ray& ray) { return ray.direction == rays[0].direction; });
  if (!(parallel ? set_parallel(packet, widest) : set_leaning(packet))) return std::nullopt;
  return packet;
}

}  // namespace kairos
