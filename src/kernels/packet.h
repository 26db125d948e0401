// Rays that go about the same way from one origin, or parallel to each other, traced together.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include <kairos/tracer.h>

#include "kernels/ray_state.h"

namespace kairos {

/// One AVX-512 register of floats.
inline constexpr size_t kPacketLanes = 16;

/// Coordinates as in RayFrame, of a ray in the midst of the packet's. From one origin, what tells the rays apart is how
/// far each leans from its direction; parallel ones, how far off it each is. Per lane: see `rays_per_register`.
struct alignas(64) RayPacket {
  // Ray i passes a point (u, v, depth) of the frame by u - lean_u reach, v - lean_v reach: reach is the depth for rays
  // from one origin, and 1 for parallel ones.
  float lean_u[kPacketLanes], lean_v[kPacketLanes];
  float dist_per_depth[kPacketLanes];  ///< > 0
  float start[kPacketLanes];           ///< the distance of its origin from where the depth is 0; of one origin: 0
  float last_start = 0;                ///< largest of them
  float widest_u = 0, widest_v = 0;    ///< largest magnitude of lean_u, lean_v, rounded up
  float least_dist_per_depth = 0;      ///< of all rays

  bool parallel = false;
  Vec3f origin;  ///< of the frame; no ray begins at a smaller depth
  int ku = 0, kv = 1, kw = 2;
  float shear_u = 0, shear_v = 0;
  float ahead = 1;  ///< depth = ahead * p[kw]: 1 or -1

  float direction_low[3] = {}, direction_high[3] = {};  ///< of all rays, not of different signs
  float origin_low[3] = {}, origin_high[3] = {};        ///< of all rays, where their depth is 0; rounded outwards

  std::span<const Ray> rays;
  size_t rays_per_register =
      kPacketLanes;  ///< 16, beside one triangle; or 4, beside four triangles: lane / 4 is the ray
  size_t ray_of(size_t lane) const { return lane / (kPacketLanes / rays_per_register); }
};

/// Nothing when the rays (1 to 16 of them, traceable) are neither parallel and no farther apart than `widest`, nor go
/// about the same way from one point and at right angles to no axis: those are traced one by one.
std::optional<RayPacket> make_packet(std::span<const Ray> rays, float widest = std::numeric_limits<float>::infinity());

}  // namespace kairos
