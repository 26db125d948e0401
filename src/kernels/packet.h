// Rays that go the same way from one origin, traced together.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <kairos/tracer.h>

#include "kernels/ray_state.h"

namespace kairos {

/// One AVX-512 register of floats.
inline constexpr size_t kPacketLanes = 16;

/// Coordinates as in RayFrame, of a direction in the midst of the rays'; what tells the rays apart is how far each
/// leans from it. Per lane: see `rays_per_register`.
struct alignas(64) RayPacket {
  // Ray i leans by lean_u, lean_v per unit of depth: it passes a point (u, v, depth) of the frame by
  // u - lean_u depth, v - lean_v depth.
  float lean_u[kPacketLanes], lean_v[kPacketLanes];
  float dist_per_depth[kPacketLanes];  ///< > 0
  float widest_u = 0, widest_v = 0;    ///< largest magnitude of lean_u, lean_v, rounded up
  float least_dist_per_depth = 0;      ///< of all rays

  Vec3f origin;
  int ku = 0, kv = 1, kw = 2;
  float shear_u = 0, shear_v = 0;
  float ahead = 1;  ///< depth = ahead * p[kw]: 1 or -1

  float direction_low[3] = {}, direction_high[3] = {};  ///< of all rays, neither zero nor of different signs

  std::span<const Ray> rays;
  size_t rays_per_register =
      kPacketLanes;  ///< 16, beside one triangle; or 4, beside four triangles: lane / 4 is the ray
  size_t ray_of(size_t lane) const { return lane / (kPacketLanes / rays_per_register); }
};

/// Nothing when the rays (1 to 16 of them, traceable) do not go the same way from one point, or at right angles to an
/// axis: those are traced one by one.
std::optional<RayPacket> make_packet(std::span<const Ray> rays);

}  // namespace kairos
