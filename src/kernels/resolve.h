// From what a ray meets to what it sees: the lower envelope over time of pieces of linear distance.
#pragma once

#include <cstdint>
#include <vector>

#include <kairos/tracer.h>

namespace kairos {

/// Scratch of resolve_visible.
struct ResolveScratch {
  /// A hit that has begun and may not have ended.
  struct Piece {
    float begin, end;
    float dist, slope;  ///< distance at begin, and its change per shutter time
    float dist_end;
    float nearest, farthest;  ///< distance over the whole hit
    uint32_t hit;             ///< index
  };
  std::vector<Piece> pieces, pending;
  std::vector<uint32_t> dealt, order;
};

/// Replaces `out` by the visible segments of `hits` (in any order): disjoint, in time order, no shorter than
/// kTimeSnap, stretches of one side of one triangle that follow on each other joined. Where two pieces are equally far,
/// the one that is nearer afterwards is seen, then that of the lower mesh and triangle index. A sweep over begins and
/// crossings: O(n log n) plus the number of changes times the number of hits that overlap there and are not hidden to
/// their end.
void resolve_visible(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out);

/// Replaces `out` by the stretches of time in which there is any hit, in order. Those closer than kTimeSnap are joined.
void unite_hits(const std::vector<Segment>& hits, std::vector<TimeRange>& out);

/// Replaces `out` by all hits, ordered by begin, mesh, triangle; stretches of one side of one triangle that follow on
/// each other are joined.
void order_all(std::vector<Segment>& hits, std::vector<Segment>& out);

}  // namespace kairos
