// Exact shadows for all that the rays of a packet see, which may be those of several pixels.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <kairos/tracer.h>

#include "shading/exact_shadows.h"

namespace kairos {

/// Of each ray, the resting point that it sees first. There are others only where what it sees at rest is cut out or
/// meets at an edge. One thread's scratch memory.
class PacketShadows {
 public:
  /// All of the packet's rays and what they see, over all of the window.
  void look(const ExactShadows& shadows, std::span<const Ray> rays, std::span<const SeenByRay> seen,
            const TimeRange& window) {
    steps_.clear();
    for (size_t r = 0; r < rays.size(); ++r) {
      const auto on = std::find_if(seen[r].segments.begin(), seen[r].segments.end(),
                                   [&](const Segment& segment) { return shadows.on(segment.mesh); });
      looks_[r] = {kNoMesh, 0, 0};
      if (on == seen[r].segments.end()) continue;
      looks_[r] = {on->mesh, on->triangle, steps_.points()};
      steps_.add(shadows, rays[r], on->mesh, on->triangle);
    }
    steps_.look(shadows, window);
  }

  /// Of a ray's point on a triangle; none where that was not looked at.
  std::span<const RestingLightSteps::Step> steps(size_t ray, uint32_t mesh, uint32_t triangle) const {
    const Look& look = looks_[ray];
    if (look.mesh != mesh || look.triangle != triangle) return {};
    return steps_.steps(look.point);
  }
  TraceCounters counters() const { return steps_.counters(); }

 private:
  struct Look {
    uint32_t mesh, triangle;
    size_t point;
  };
  RestingLightSteps steps_;
  std::array<Look, Tracer::kMaxPacket> looks_{};  // [ray]
};

}  // namespace kairos
