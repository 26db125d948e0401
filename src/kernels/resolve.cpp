#include "kernels/resolve.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "kernels/time_bins.h"

namespace kairos {

namespace {

using Piece = ResolveScratch::Piece;

bool earlier(const Segment& a, const Segment& b) {
  return std::tie(a.begin, a.mesh, a.triangle) < std::tie(b.begin, b.mesh, b.triangle);
}

/// Indices of the hits by begin, in the low half of each key; above it the begin's bits, which order like the number
/// since it is not negative.
void sort_by_begin(const std::vector<Segment>& hits, std::vector<uint64_t>& order) {
  order.resize(hits.size());
  for (size_t i = 0; i < hits.size(); ++i)
    order[i] = static_cast<uint64_t>(std::bit_cast<uint32_t>(hits[i].begin)) << 32 | i;
  constexpr size_t kInsertionSortCount = 24;
  if (order.size() > kInsertionSortCount) {
    std::sort(order.begin(), order.end());
    return;
  }
  for (size_t i = 1; i < order.size(); ++i) {
    const uint64_t key = order[i];
    size_t place = i;
    for (; place > 0 && key < order[place - 1]; --place) order[place] = order[place - 1];
    order[place] = key;
  }
}

float distance(const Piece& piece, float time) { return piece.dist + (time - piece.begin) * piece.slope; }

bool same_surface(const Segment& a, const Segment& b) {
  return a.mesh == b.mesh && a.triangle == b.triangle && a.front == b.front;
}

class Sweep {
 public:
  Sweep(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out)
      : hits_(hits), order_(scratch.order), active_(scratch.active), out_(out) {}

  void run() {
    out_.clear();
    while (next_ < order_.size()) {
      active_.clear();
      now_ = emitted_ = next_hit().begin;
      while (next_ < order_.size() && next_hit().begin <= now_) take_up();
      while (choose()) advance();
      // A sliver before a gap has nothing after it that it could be left to.
      if (!out_.empty() && out_.back().end == emitted_) out_.back().end = now_;
    }
    if (out_.empty()) return;
    // Nor has one at the shutter's ends.
    if (out_.front().begin < kTimeSnap) out_.front().begin = 0;
    if (1 - out_.back().end < kTimeSnap) out_.back().end = 1;
  }

 private:
  const Segment& next_hit() const { return hits_[static_cast<uint32_t>(order_[next_])]; }

  /// Makes the next hit one of the active ones.
  void take_up() {
    const Segment& hit = next_hit();
    active_.push_back({hit.begin, hit.end, hit.dist_begin, (hit.dist_end - hit.dist_begin) / (hit.end - hit.begin),
                       std::min(hit.dist_begin, hit.dist_end), std::max(hit.dist_begin, hit.dist_end),
                       static_cast<uint32_t>(order_[next_])});
    ++next_;
  }

  /// True when `a` is seen rather than `b` from now on.
  bool in_front(const Piece& a, const Piece& b) const {
    const float da = distance(a, now_), db = distance(b, now_);
    if (da != db) return da < db;
    if (a.slope != b.slope) return a.slope < b.slope;
    const Segment &ha = hits_[a.hit], &hb = hits_[b.hit];
    return std::tie(ha.mesh, ha.triangle) < std::tie(hb.mesh, hb.triangle);
  }

  /// Forgets what is over and finds what is seen from now on; false when nothing is.
  bool choose() {
    size_t kept = 0;
    for (size_t i = 0; i < active_.size(); ++i)
      if (active_[i].end > now_) {
        if (kept != i) active_[kept] = active_[i];
        ++kept;
      }
    active_.resize(kept);
    if (kept == 0) return false;
    size_t seen = 0;
    for (size_t i = 1; i < kept; ++i)
      if (in_front(active_[i], active_[seen])) seen = i;
    see(seen);
    return true;
  }

  /// From now on active_[index] is seen: until it ends, or another comes in front of it.
  void see(size_t index) {
    seen_ = index;
    change_ = active_[index].end;
    for (const Piece& other : active_) limit_by(other);
  }

  /// Brings change_ forward to when `other` comes in front of what is seen.
  void limit_by(const Piece& other) {
    const Piece& seen = active_[seen_];
    if (other.nearest >= seen.farthest) return;
    const float closing = seen.slope - other.slope, gap = distance(other, now_) - distance(seen, now_);
    if (!(gap > 0) || !(gap < closing * (change_ - now_))) return;  // no gap: a tie, which in_front has decided
    const float time = now_ + std::max(gap / closing, kTimeSnap);   // at least a sliver, so that the sweep goes on
    if (time < other.end) change_ = std::min(change_, time);
  }

  /// Goes on to the next change that only choose() can decide, and notes down what was seen until then.
  void advance() {
    // A hit that begins within a sliver of the end takes over from it, without a gap.
    while (next_ < order_.size() && next_hit().begin <= change_ + kTimeSnap) {
      now_ = std::min(std::max(now_, next_hit().begin), change_);
      take_up();
      if (active_.back().end <= now_) continue;
      if (in_front(active_.back(), active_[seen_])) {
        emit();
        see(active_.size() - 1);
      } else {
        limit_by(active_.back());
      }
    }
    now_ = change_;
    emit();
  }

  /// What is seen was so from the last emission until now. Slivers are left to what follows; a run of them that grows
  /// to more than a sliver goes to the last of them.
  void emit() {
    if (now_ - emitted_ < kTimeSnap) return;
    const Piece& seen = active_[seen_];
    const Segment& hit = hits_[seen.hit];
    const float dist_end = now_ == hit.end ? hit.dist_end : distance(seen, now_);
    if (!out_.empty() && out_.back().end == emitted_ && same_surface(out_.back(), hit)) {
      out_.back().end = now_;
      out_.back().dist_end = dist_end;
    } else {
      out_.push_back({emitted_, now_, emitted_ == hit.begin ? hit.dist_begin : distance(seen, emitted_), dist_end,
                      hit.mesh, hit.triangle, hit.front});
    }
    emitted_ = now_;
  }

  const std::vector<Segment>& hits_;
  const std::vector<uint64_t>& order_;
  std::vector<Piece>& active_;
  std::vector<Segment>& out_;
  size_t next_ = 0;    // first hit not taken up, as a place in order_
  size_t seen_ = 0;    // index into active_
  float now_ = 0;      // everything before is decided
  float change_ = 0;   // until then `seen_` is in front of all active hits
  float emitted_ = 0;  // end of the last segment
};

}  // namespace

void resolve_visible(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out) {
  sort_by_begin(hits, scratch.order);
  Sweep(hits, scratch, out).run();
}

void order_all(std::vector<Segment>& hits, std::vector<Segment>& out) {
  std::sort(hits.begin(), hits.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.mesh, a.triangle, a.begin, a.front) < std::tie(b.mesh, b.triangle, b.begin, b.front);
  });
  out.clear();
  for (const Segment& hit : hits) {
    if (!out.empty() && same_surface(out.back(), hit) && hit.begin <= out.back().end + kTimeSnap) {
      out.back().end = std::max(out.back().end, hit.end);
      out.back().dist_end = hit.dist_end;
    } else {
      out.push_back(hit);
    }
  }
  std::stable_sort(out.begin(), out.end(), earlier);
}

}  // namespace kairos
