// Blended surfaces: hits on what hides nothing, such as tinted glass or gauze, cut down to where they can be seen.
#pragma once

#include <vector>

#include <kairos/tracer.h>

namespace kairos {

/// Scratch of clip_blended.
struct BlendedScratch {
  struct Stretch {
    float begin, end;
  };
  std::vector<Stretch> hidden;
  std::vector<Segment> in_time_order;
};

/// Replaces `out` by the parts of `blended` that no hit of `opaque` is in front of: ordered by begin, then mesh,
/// triangle and distance; none shorter than kTimeSnap. They may overlap in time. All distances run straight between
/// their ends. At equal distance the lower mesh and triangle is in front. O(n log n) plus the number of pairs that
/// overlap in time.
void clip_blended(const std::vector<Segment>& blended, const std::vector<Segment>& opaque, BlendedScratch& scratch,
                  std::vector<Segment>& out);

}  // namespace kairos
