// How much of the shutter is already closed off, and at what distance: culls what is hidden for all of its time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kairos {

/// Ends of hits closer than this, in shutter time, count as touching: a gap or overlap of rounding errors between
/// triangles that share an edge must not open a bin, nor become a segment.
inline constexpr float kTimeSnap = 1e-6f;

/// Sixteen equal bins of shutter time, each with the distance behind which everything in it is hidden.
///
/// A hit that spans a whole bin closes it at once. Small fast triangles span none alone, so each bin also keeps two
/// open runs: stretches covered without a gap by hits so far, with their farthest distance. A run that grows to the
/// whole bin closes it. docs/method.md, "Traversal and occlusion".
class TimeBins {
 public:
  static constexpr int kCount = 16;

  void clear() {
    hidden_behind_.fill(std::numeric_limits<float>::infinity());
    for (auto& runs : runs_) runs[0].end = runs[1].end = -1;
  }

  /// The farthest anything in [begin, end] can be and still be seen.
  float visible_until(float begin, float end) const {
    const int last = last_bin(end);
    float farthest = 0;
    for (int bin = first_bin(begin); bin <= last; ++bin) farthest = std::max(farthest, at(bin));
    return farthest;
  }

  /// Takes from [begin, end] what is hidden for things at `dist` or beyond; false when nothing remains.
  bool clip(float dist, float& begin, float& end) const {
    int first = first_bin(begin), last = last_bin(end);
    if (dist <= at(first) && dist <= at(last)) return true;
    while (first <= last && dist > at(first)) ++first;
    if (first > last) return false;
    while (dist > at(last)) --last;
    begin = std::max(begin, static_cast<float>(first) * kWidth);
    end = std::min(end, static_cast<float>(last + 1) * kWidth);
    return true;
  }

  /// An opaque hit over [begin, end], distances linear between both ends and not beyond them.
  void cover(float begin, float end, float dist_begin, float dist_end) {
    const int first = first_bin(begin), last = last_bin(end);
    const float farthest = std::max(dist_begin, dist_end);
    for (int bin = first; bin <= last; ++bin) {
      const float bin_begin = static_cast<float>(bin) * kWidth, bin_end = static_cast<float>(bin + 1) * kWidth;
      if (begin <= bin_begin && end >= bin_end)
        close(bin, farthest);
      else if (farthest < at(bin))
        grow_run(bin, std::max(begin, bin_begin), std::min(end, bin_end), farthest);
    }
  }

  /// For what is hidden from several rays at once: the farthest of each bin. Runs are no part of it.
  void set_to_farthest(const TimeBins& other) { hidden_behind_ = other.hidden_behind_; }
  void widen_to(const TimeBins& other) {
    for (size_t bin = 0; bin < kCount; ++bin)
      hidden_behind_[bin] = std::max(hidden_behind_[bin], other.hidden_behind_[bin]);
  }

  /// Everything behind `dist` is hidden at all times.
  void cover_all(float dist) {
    for (int bin = 0; bin < kCount; ++bin) close(bin, dist);
  }

 private:
  static constexpr float kWidth = 1.0f / kCount;

  struct Run {
    float begin, end, farthest;  ///< end < begin: unused
  };

  static int first_bin(float begin) { return std::min(static_cast<int>(begin * kCount), kCount - 1); }
  static int last_bin(float end) {
    const float place = end * kCount;
    const int bin = static_cast<int>(place);
    return std::min(static_cast<float>(bin) == place && bin > 0 ? bin - 1 : bin, kCount - 1);
  }
  float at(int bin) const { return hidden_behind_[static_cast<size_t>(bin)]; }
  void close(int bin, float dist) {
    float& hidden = hidden_behind_[static_cast<size_t>(bin)];
    hidden = std::min(hidden, dist);
  }

  static bool touch(const Run& a, float begin, float end) {
    return begin <= a.end + kTimeSnap && end >= a.begin - kTimeSnap;
  }

  void grow_run(int bin, float begin, float end, float farthest) {
    auto& runs = runs_[static_cast<size_t>(bin)];
    const float bin_begin = static_cast<float>(bin) * kWidth, bin_end = static_cast<float>(bin + 1) * kWidth;
    Run grown{begin, end, farthest};
    bool joined = false;
    for (Run& run : runs)
      if (run.end >= 0 && touch(run, grown.begin, grown.end)) {
        grown = {std::min(run.begin, grown.begin), std::max(run.end, grown.end),
                 std::max(run.farthest, grown.farthest)};
        run.end = -1;
        joined = true;
      }
    if (grown.begin <= bin_begin + kTimeSnap && grown.end >= bin_end - kTimeSnap) {
      close(bin, grown.farthest);
      return;
    }
    Run* slot = runs[0].end < 0 ? &runs[0] : runs[1].end < 0 ? &runs[1] : nullptr;
    if (slot == nullptr && !joined) {  // both taken: the shorter one gives way
      slot = runs[0].end - runs[0].begin < runs[1].end - runs[1].begin ? &runs[0] : &runs[1];
      if (slot->end - slot->begin >= grown.end - grown.begin) return;
    }
    *slot = grown;
  }

  alignas(64) std::array<float, kCount> hidden_behind_;
  std::array<std::array<Run, 2>, kCount> runs_;
};

}  // namespace kairos
