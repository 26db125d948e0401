// From what a ray meets to what it sees: the lower envelope over time of pieces of linear distance.
#pragma once

#include <cstdint>
#include <vector>

#include <kairos/tracer.h>

namespace kairos {

/// Scratch of resolve_visible.
struct ResolveScratch {
  struct Piece {
    Segment hit;
    float slope;  ///< distance per shutter time
  };
  std::vector<Piece> active;
  std::vector<uint64_t> order;
};

/// Replaces `out` by the visible segments of `hits` (in any order): disjoint, in time order, no shorter than
/// kTimeSnap, stretches of one side of one triangle that follow on each other joined. Where two pieces are equally far,
/// the one that is nearer afterwards is seen, then that of the lower mesh and triangle index. A sweep over begins and
/// crossings: O(n log n) plus the number of changes times the number of hits that overlap there.
void resolve_visible(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out);

/// Replaces `out` by all hits, ordered by begin, mesh, triangle; stretches of one side of one triangle that follow on
/// each other are joined.
void order_all(std::vector<Segment>& hits, std::vector<Segment>& out);

}  // namespace kairos
