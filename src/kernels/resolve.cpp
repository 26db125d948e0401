#include "kernels/resolve.h"

#include <algorithm>
#include <bit>
#include <limits>
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

float distance(const Piece& piece, float time) { return piece.hit.dist_begin + (time - piece.hit.begin) * piece.slope; }

bool same_surface(const Segment& a, const Segment& b) {
  return a.mesh == b.mesh && a.triangle == b.triangle && a.front == b.front;
}

/// True when `a` is seen rather than `b` from `time` on.
bool in_front(const Piece& a, const Piece& b, float time) {
  const float da = distance(a, time), db = distance(b, time);
  if (da != db) return da < db;
  if (a.slope != b.slope) return a.slope < b.slope;
  return std::tie(a.hit.mesh, a.hit.triangle) < std::tie(b.hit.mesh, b.hit.triangle);
}

class Sweep {
 public:
  Sweep(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out)
      : hits_(hits), order_(scratch.order), active_(scratch.active), out_(out) {}

  void run() {
    active_.clear();
    out_.clear();
    while (next_ < order_.size()) {
      now_ = next_hit().begin;
      emitted_ = now_;
      admit();
      while (choose()) step();
    }
    if (out_.empty()) return;
    // Slivers at the shutter's ends have nothing that they could be left to.
    if (out_.front().begin < kTimeSnap) out_.front().begin = 0;
    if (1 - out_.back().end < kTimeSnap) out_.back().end = 1;
  }

 private:
  const Segment& next_hit() const { return hits_[static_cast<uint32_t>(order_[next_])]; }

  /// Takes up every hit that begins by now. The one seen now may change.
  void admit() {
    for (; next_ < order_.size() && next_hit().begin <= now_ + kTimeSnap; ++next_) {
      const Segment& hit = next_hit();
      if (hit.end - now_ < kTimeSnap) continue;
      active_.push_back({hit, (hit.dist_end - hit.dist_begin) / (hit.end - hit.begin)});
    }
  }

  /// Finds what is seen from now on; false when nothing is.
  bool choose() {
    size_t kept = 0;
    for (size_t i = 0; i < active_.size(); ++i)
      if (active_[i].hit.end - now_ >= kTimeSnap) active_[kept++] = active_[i];
    active_.resize(kept);
    if (kept == 0) return false;
    seen_ = 0;
    for (size_t i = 1; i < kept; ++i)
      if (in_front(active_[i], active_[seen_], now_)) seen_ = i;
    change_ = active_[seen_].hit.end;
    for (size_t i = 0; i < kept; ++i) change_ = std::min(change_, crossing(active_[i]));
    return true;
  }

  /// When `other` comes in front of what is seen now; infinity for never.
  float crossing(const Piece& other) const {
    const Piece& seen = active_[seen_];
    const float closing = seen.slope - other.slope;
    if (!(closing > 0)) return std::numeric_limits<float>::infinity();
    const float gap = distance(other, now_) - distance(seen, now_);
    if (!(gap > 0)) return std::numeric_limits<float>::infinity();  // a tie that was decided
    const float time = now_ + std::max(gap / closing, kTimeSnap);   // at least a sliver, so that the sweep goes on
    return time < other.hit.end ? time : std::numeric_limits<float>::infinity();
  }

  /// Goes on to the next instant at which something may change, and notes down what was seen until then.
  void step() {
    while (next_ < order_.size() && next_hit().begin <= change_ + kTimeSnap) {
      const Segment& hit = next_hit();
      now_ = std::min(std::max(now_, hit.begin), change_);
      if (hit.end - now_ < kTimeSnap) {
        ++next_;
        continue;
      }
      active_.push_back({hit, (hit.dist_end - hit.dist_begin) / (hit.end - hit.begin)});
      ++next_;
      if (in_front(active_.back(), active_[seen_], now_)) {
        emit(now_);
        return;
      }
      change_ = std::min(change_, crossing(active_.back()));
    }
    now_ = change_;
    emit(now_);
  }

  /// What is seen was so from the last emission until `time`. Slivers are left to what follows.
  void emit(float time) {
    const Piece& seen = active_[seen_];
    if (time - emitted_ < kTimeSnap) return;
    if (!out_.empty() && out_.back().end == emitted_ && same_surface(out_.back(), seen.hit)) {
      out_.back().end = time;
      out_.back().dist_end = distance(seen, time);
    } else {
      Segment segment = seen.hit;
      segment.dist_begin = emitted_ == segment.begin ? segment.dist_begin : distance(seen, emitted_);
      segment.dist_end = time == segment.end ? segment.dist_end : distance(seen, time);
      segment.begin = emitted_;
      segment.end = time;
      out_.push_back(segment);
    }
    emitted_ = time;
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
