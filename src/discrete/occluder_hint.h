// What a discrete ray to what stands still says of a time-continuous one at its place.
#pragma once

#include <optional>

#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"

namespace kairos {

/// As Tracer::trace_packet takes it. hit: of DiscreteLayer::still.
inline Segment occluder_hint(const std::optional<DiscreteHit>& hit) {
  if (!hit) return {};
  return {0, 1, hit->dist, hit->dist, hit->mesh, hit->triangle, hit->front};
}

}  // namespace kairos
