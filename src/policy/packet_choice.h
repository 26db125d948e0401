// Whether the time-continuous rays of a pixel are better traced together or one by one.
#pragma once

#include <cstdint>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "shading/pixel_context.h"

namespace kairos {

/// Rays of a packet share the traversal, but are tested against what any of them may meet: where triangles are much
/// smaller than pixels and fast, that is more than is saved.
struct PacketChoice {
  bool large = true, small = true;  ///< packets of more than four rays, and of three or four

  /// Do a pixel's `count` rays go together?
  bool together(uint32_t count) const { return count > 4 ? large : count > 2 && small; }
};

/// From the work of a few rays, spread over the picture, traced both ways: no clock is asked.
PacketChoice choose_packets(const PixelContext& context, const Projection& projection, const Tracer& tracer);

}  // namespace kairos
