// Whether time-continuous rays are better traced together or one by one.
#pragma once

#include <bit>
#include <cstdint>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "shading/pixel_context.h"

namespace kairos {

/// Rays of a packet share the traversal, but are tested against what any of them may meet: where triangles are much
/// smaller than the packet and fast, that is more than is saved.
struct PacketChoice {
  bool large = true, small = true;  ///< of a pixel's rays: packets of more than four, and of three or four
  bool strips = true;               ///< packets of several pixels that have three to eight rays each
  bool long_strips = true;          ///< packets of eight or sixteen pixels that have one ray or two

  /// Do a pixel's `count` rays go together, by themselves?
  bool together(uint32_t count) const { return count > 4 ? large : count > 2 && small; }

  /// A packet has sixteen places, and few rays of a pixel would leave most of them empty. So the rays of so many pixels
  /// beside each other go together, from a multiple of their number on; 1: those of a pixel do or don't. A power of two
  /// of at most kLongestStrip.
  int strip(uint32_t count) const {
    if (count == 0 || count > Tracer::kMaxPacket / 2 || !(count > 2 ? strips : long_strips)) return 1;
    return static_cast<int>(std::bit_floor(Tracer::kMaxPacket / count));
  }
  static constexpr int kLongestStrip = Tracer::kMaxPacket;
  /// The same, whatever their number.
  int longest_strip() const { return strips || long_strips ? kLongestStrip : 1; }
};

/// From the work of a few rays, spread over the picture, traced in all of these ways: no clock is asked.
PacketChoice choose_packets(const PixelContext& context, const Projection& projection, const Tracer& tracer);

}  // namespace kairos
