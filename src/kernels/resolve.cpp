#include "kernels/resolve.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "kernels/counting_sort.h"
#include "kernels/time_bins.h"

namespace kairos {

namespace {

using Piece = ResolveScratch::Piece;

bool earlier(const Segment& a, const Segment& b) {
  return std::tie(a.begin, a.mesh, a.triangle) < std::tie(b.begin, b.mesh, b.triangle);
}

/// Parts of the shutter that the hits of long lists are dealt out to by their begins.
constexpr size_t kParts = 16;

size_t part_of(float begin) { return std::min(static_cast<size_t>(begin * static_cast<float>(kParts)), kParts - 1); }

/// Behind `count` numbers, what sort_by_counting wants there.
void pad(float* numbers, size_t count) {
  std::fill_n(numbers + count, kCountingSortLanes, std::numeric_limits<float>::infinity());
}

/// Fills scratch.order with the hits' indices by begin; of those that begin together, the lower index first.
void sort_by_begin(const std::vector<Segment>& hits, ResolveScratch& scratch) {
  const size_t count = hits.size();
  scratch.order.resize(count);
  if (count <= kCountingSortCount) {
    std::array<float, kCountingSortCount + kCountingSortLanes> begins;
    for (size_t i = 0; i < count; ++i) begins[i] = hits[i].begin;
    pad(begins.data(), count);
    return sort_by_counting(begins.data(), count, scratch.order.data());
  }
  std::array<uint32_t, kParts + 1> ends{};  // [part + 1]: first of counts, then of running sums
  for (const Segment& hit : hits) ++ends[part_of(hit.begin) + 1];
  for (size_t part = 0; part < kParts; ++part) ends[part + 1] += ends[part];
  std::array<uint32_t, kParts> next;
  std::copy_n(ends.begin(), kParts, next.begin());
  scratch.dealt.resize(count);
  for (size_t i = 0; i < count; ++i) scratch.dealt[next[part_of(hits[i].begin)]++] = static_cast<uint32_t>(i);
  for (size_t part = 0; part < kParts; ++part) {
    const uint32_t* dealt = scratch.dealt.data() + ends[part];
    uint32_t* order = scratch.order.data() + ends[part];
    const size_t size = ends[part + 1] - ends[part];
    if (size > kCountingSortCount) {
      std::copy_n(dealt, size, order);
      std::stable_sort(order, order + size, [&](uint32_t a, uint32_t b) { return hits[a].begin < hits[b].begin; });
      continue;
    }
    std::array<float, kCountingSortCount + kCountingSortLanes> begins;
    for (size_t i = 0; i < size; ++i) begins[i] = hits[dealt[i]].begin;
    pad(begins.data(), size);
    sort_by_counting(begins.data(), size, order);
    for (size_t i = 0; i < size; ++i) order[i] = dealt[order[i]];
  }
}

bool same_surface(const Segment& a, const Segment& b) {
  return a.mesh == b.mesh && a.triangle == b.triangle && a.front == b.front;
}

float distance(const Piece& piece, float time) { return piece.dist + (time - piece.begin) * piece.slope; }

/// What is seen, and beside it the pieces that may be seen later: those that are not hidden by it to their end.
class Sweep {
 public:
  Sweep(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out)
      : hits_(hits), order_(scratch.order), pieces_(scratch.pieces), pending_(scratch.pending), out_(out) {}

  void run() {
    out_.clear();
    pending_.clear();
    make_pieces();
    while (next_ < pieces_.size()) {
      seen_ = pieces_[next_++];
      now_ = emitted_ = seen_.begin;
      change_ = seen_.end;
      do {
        advance();
      } while (choose());
      // A sliver before a gap has nothing after it that it could be left to.
      if (!out_.empty() && out_.back().end == emitted_) out_.back().end = now_;
    }
    if (out_.empty()) return;
    // Nor has one at the shutter's ends.
    if (out_.front().begin < kTimeSnap) out_.front().begin = 0;
    if (1 - out_.back().end < kTimeSnap) out_.back().end = 1;
  }

 private:
  /// All hits as pieces, in order.
  void make_pieces() {
    pieces_.resize(order_.size());
    for (size_t i = 0; i < pieces_.size(); ++i) {
      const uint32_t index = order_[i];
      const Segment& hit = hits_[index];
      pieces_[i] = {hit.begin,
                    hit.end,
                    hit.dist_begin,
                    (hit.dist_end - hit.dist_begin) / (hit.end - hit.begin),
                    hit.dist_end,
                    std::min(hit.dist_begin, hit.dist_end),
                    std::max(hit.dist_begin, hit.dist_end),
                    index};
    }
  }

  /// True when `a` is seen rather than `b` from now on.
  bool in_front(const Piece& a, const Piece& b) const {
    const float da = distance(a, now_), db = distance(b, now_);
    if (da != db) return da < db;
    if (a.slope != b.slope) return a.slope < b.slope;
    const Segment &ha = hits_[a.hit], &hb = hits_[b.hit];
    return std::tie(ha.mesh, ha.triangle) < std::tie(hb.mesh, hb.triangle);
  }

  /// Both are there now, `front` in front. Does it hide `back` until that ends?
  static bool hides(const Piece& front, const Piece& back) {
    return back.end <= front.end && back.dist_end >= distance(front, back.end);
  }

  /// `piece` may be seen later.
  void wait(const Piece& piece) {
    pending_.push_back(piece);
    pending_from_ = std::min(pending_from_, piece.nearest);
  }

  /// What was seen is over now, or something else in front of it, and `piece` is there.
  void take_over(const Piece& piece) {
    if (seen_.end <= now_ && piece.farthest < pending_from_) {
      seen_ = piece;
      change_ = piece.end;
      return;
    }
    pending_.push_back(piece);
    choose();
  }

  /// Forgets what is over and finds what is seen from now on; false when nothing is.
  bool choose() {
    if (seen_.end > now_)
      pending_.push_back(seen_);
    else if (pending_.size() == 1)
      return choose_only();
    size_t kept = 0, nearest = 0;
    for (const Piece& piece : pending_) {
      if (!(piece.end > now_)) continue;
      if (kept > 0 && in_front(piece, pending_[nearest])) nearest = kept;
      pending_[kept++] = piece;  // kept is not beyond the one being read
    }
    pending_.resize(kept);
    pending_from_ = std::numeric_limits<float>::infinity();
    if (kept == 0) return false;
    const Piece chosen = pending_[nearest];
    pending_[nearest] = pending_.back();
    pending_.pop_back();
    for (const Piece& piece : pending_) pending_from_ = std::min(pending_from_, piece.nearest);
    see(chosen);
    return true;
  }

  /// The same where one piece waits, as what lies behind fast and thin things does most of the time.
  bool choose_only() {
    const Piece only = pending_.front();
    pending_.clear();
    pending_from_ = std::numeric_limits<float>::infinity();
    if (!(only.end > now_)) return false;
    seen_ = only;
    change_ = only.end;
    return true;
  }

  /// From now on `piece` is seen: until it ends, or another comes in front of it.
  void see(const Piece& piece) {
    seen_ = piece;
    change_ = piece.end;
    if (piece.farthest <= pending_from_) return;
    for (const Piece& other : pending_) limit_by(other);
  }

  /// Brings change_ forward to when `other` comes in front of what is seen.
  void limit_by(const Piece& other) {
    if (other.nearest >= seen_.farthest) return;
    const float closing = seen_.slope - other.slope, gap = distance(other, now_) - distance(seen_, now_);
    if (!(gap > 0) || !(gap < closing * (change_ - now_))) return;  // no gap: a tie, which in_front has decided
    const float time = now_ + std::max(gap / closing, kTimeSnap);   // at least a sliver, so that the sweep goes on
    if (time < other.end) change_ = std::min(change_, time);
  }

  /// Goes on to the next change that only choose() can decide, and notes down what was seen until then.
  void advance() {
    // A hit that begins within a sliver of the end takes over from it, without a gap.
    while (next_ < pieces_.size() && pieces_[next_].begin <= change_ + kTimeSnap) {
      const Piece& piece = pieces_[next_++];
      now_ = std::min(std::max(now_, piece.begin), change_);
      if (piece.end <= now_) continue;
      if (change_ <= now_) {  // the most common case by far: triangles of one surface that follow on each other
        emit();
        take_over(piece);
      } else if (in_front(piece, seen_)) {
        emit();
        const Piece before = seen_;
        see(piece);
        if (!hides(piece, before)) {
          wait(before);
          limit_by(before);
        }
      } else if (!hides(seen_, piece)) {
        wait(piece);
        limit_by(piece);
      }
    }
    now_ = change_;
    emit();
  }

  /// What is seen was so from the last emission until now. Slivers are left to what follows; a run of them that grows
  /// to more than a sliver goes to the last of them.
  void emit() {
    if (now_ - emitted_ < kTimeSnap) return;
    const Segment& hit = hits_[seen_.hit];
    const float dist_end = now_ == hit.end ? hit.dist_end : distance(seen_, now_);
    if (!out_.empty() && out_.back().end == emitted_ && same_surface(out_.back(), hit)) {
      out_.back().end = now_;
      out_.back().dist_end = dist_end;
    } else {
      out_.push_back({emitted_, now_, emitted_ == hit.begin ? hit.dist_begin : distance(seen_, emitted_), dist_end,
                      hit.mesh, hit.triangle, hit.front});
    }
    emitted_ = now_;
  }

  const std::vector<Segment>& hits_;
  const std::vector<uint32_t>& order_;
  std::vector<Piece>& pieces_;
  std::vector<Piece>& pending_;
  std::vector<Segment>& out_;
  Piece seen_{};
  float pending_from_ = std::numeric_limits<float>::infinity();  // nothing pending comes nearer
  size_t next_ = 0;                                              // first hit not accepted, as a place in pieces_
  float now_ = 0;                                                // everything before is decided
  float change_ = 0;   // until then `seen_` is in front of everything that has begun
  float emitted_ = 0;  // end of the last segment
};

}  // namespace

void resolve_visible(const std::vector<Segment>& hits, ResolveScratch& scratch, std::vector<Segment>& out) {
  if (hits.size() == 1 && hits[0].end - hits[0].begin >= kTimeSnap) {  // what stands still is mostly seen so
    Segment only = hits[0];
    if (only.begin < kTimeSnap) only.begin = 0;
    if (1 - only.end < kTimeSnap) only.end = 1;
    out.assign(1, only);
    return;
  }
  sort_by_begin(hits, scratch);
  Sweep(hits, scratch, out).run();
}

void unite_hits(const std::vector<Segment>& hits, std::vector<TimeRange>& out) {
  out.clear();
  for (const Segment& hit : hits) out.push_back({hit.begin, hit.end});
  std::sort(out.begin(), out.end(), [](const TimeRange& a, const TimeRange& b) { return a.begin < b.begin; });
  size_t count = 0;
  for (const TimeRange& hit : out)
    if (count > 0 && hit.begin <= out[count - 1].end + kTimeSnap)
      out[count - 1].end = std::max(out[count - 1].end, hit.end);
    else
      out[count++] = hit;
  out.resize(count);
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
