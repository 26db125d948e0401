// How much of the shutter is already closed off, and at what distance: culls what is hidden for all of its time.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
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
///
/// Sets of bins are masks with a bit per bin. What runs over all bins has a vector version in time_bins-inl.h.
class TimeBins {
 public:
  static constexpr int kCount = 16;
  using Mask = uint32_t;

  /// Nearer than any distance: what is hidden behind it is everything.
  static constexpr float kNearest = -1;

  /// Nothing is hidden but what is farther than `most_dist`, and everything outside of [begin, end].
  void clear(float begin = 0, float end = 1, float most_dist = std::numeric_limits<float>::infinity()) {
    hidden_behind_.fill(most_dist);
    for (auto& runs : runs_) runs = {Run::none(), Run::none()};
    if (begin > 0) cover(0, begin, kNearest);
    if (end < 1) cover(end, 1, kNearest);
  }

  /// Bins that [begin, end] touches, and those that it fills; 0 <= begin <= end <= 1.
  static Mask touched(float begin, float end) { return (Mask{2} << last_bin(end)) - (Mask{1} << first_bin(begin)); }
  static Mask filled(float begin, float end) {
    const int first = first_bin(begin), last = last_bin(end);
    const int from = first + (begin > first * kWidth ? 1 : 0), to = last + (end >= (last + 1) * kWidth ? 1 : 0);
    return from < to ? (Mask{1} << to) - (Mask{1} << from) : 0;
  }

  /// Bins in which something at `dist` may be seen.
  Mask reaching(float dist) const {
    Mask bins = 0;
    for (int bin = 0; bin < kCount; ++bin) bins |= Mask{hidden_behind(bin) >= dist} << bin;
    return bins;
  }

  /// The farthest anything in `bins` can be and still be seen.
  float visible_until(Mask bins) const {
    float farthest = 0;
    for (; bins != 0; bins &= bins - 1) farthest = std::max(farthest, hidden_behind(std::countr_zero(bins)));
    return farthest;
  }

  /// Cuts [begin, end] to the first and last bins it touches of those that reach far enough; false when there are none.
  static bool clip(Mask reaching, float& begin, float& end) {
    const Mask seen = reaching & touched(begin, end);
    if (seen == 0) return false;
    begin = std::max(begin, static_cast<float>(std::countr_zero(seen)) * kWidth);
    end = std::min(end, static_cast<float>(std::bit_width(seen)) * kWidth);
    return true;
  }

  /// An opaque hit over [begin, end], no farther than `farthest`.
  void cover(float begin, float end, float farthest) {
    const Mask whole = filled(begin, end);
    close(whole, farthest);
    grow_runs(touched(begin, end) & ~whole, begin, end, farthest);
  }

  /// Everything in `bins` behind `dist` is hidden.
  void close(Mask bins, float dist) {
    for (; bins != 0; bins &= bins - 1) close_one(std::countr_zero(bins), dist);
  }

  /// The part of cover() for bins that the hit does not fill. True when it has closed one.
  bool grow_runs(Mask bins, float begin, float end, float farthest) {
    bool closed = false;
    for (; bins != 0; bins &= bins - 1) {
      const int bin = std::countr_zero(bins);
      if (!(farthest < hidden_behind(bin))) continue;
      const float bin_begin = static_cast<float>(bin) * kWidth, bin_end = static_cast<float>(bin + 1) * kWidth;
      closed |= grow_run(bin, {std::max(begin, bin_begin), std::min(end, bin_end), farthest});
    }
    return closed;
  }

  /// For what is hidden from several rays at once: the farthest of each bin. Runs are no part of it.
  void set_to_farthest(const TimeBins& other) { hidden_behind_ = other.hidden_behind_; }
  void widen_to(const TimeBins& other) {
    for (size_t bin = 0; bin < kCount; ++bin)
      hidden_behind_[bin] = std::max(hidden_behind_[bin], other.hidden_behind_[bin]);
  }

  /// [bin]: one AVX-512 register.
  const float* hidden_behind() const { return hidden_behind_.data(); }
  float* hidden_behind() { return hidden_behind_.data(); }

  static constexpr float kWidth = 1.0f / kCount;

 private:
  struct Run {
    float begin, end, farthest;

    /// Touches nothing.
    static Run none() { return {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0}; }
    float duration() const { return end - begin; }
    bool touches(const Run& other) const { return other.begin <= end + kTimeSnap && other.end >= begin - kTimeSnap; }
    void join(const Run& other) {
      begin = std::min(begin, other.begin);
      end = std::max(end, other.end);
      farthest = std::max(farthest, other.farthest);
    }
  };

  static int first_bin(float begin) { return std::min(static_cast<int>(begin * kCount), kCount - 1); }
  static int last_bin(float end) {
    const float place = end * kCount;
    const int bin = static_cast<int>(place);
    return std::min(static_cast<float>(bin) == place && bin > 0 ? bin - 1 : bin, kCount - 1);
  }
  float hidden_behind(int bin) const { return hidden_behind_[static_cast<size_t>(bin)]; }
  void close_one(int bin, float dist) {
    float& hidden = hidden_behind_[static_cast<size_t>(bin)];
    hidden = std::min(hidden, dist);
  }

  /// True when the run has grown to the whole bin.
  bool grow_run(int bin, Run grown) {
    auto& [a, b] = runs_[static_cast<size_t>(bin)];
    const bool joins_a = a.touches(grown), joins_b = b.touches(grown);
    if (joins_a) grown.join(a);
    if (joins_b) grown.join(b);
    const float bin_begin = static_cast<float>(bin) * kWidth, bin_end = static_cast<float>(bin + 1) * kWidth;
    if (grown.begin <= bin_begin + kTimeSnap && grown.end >= bin_end - kTimeSnap) {
      if (joins_a) a = Run::none();
      if (joins_b) b = Run::none();
      close_one(bin, grown.farthest);
      return true;
    }
    if (joins_a) {
      a = grown;
      if (joins_b) b = Run::none();
    } else if (joins_b) {
      b = grown;
    } else {  // it takes the place of the shorter one, which may be none, if it is longer
      Run& shorter = a.duration() < b.duration() ? a : b;
      if (shorter.duration() < grown.duration()) shorter = grown;
    }
    return false;
  }

  alignas(64) std::array<float, kCount> hidden_behind_;
  std::array<std::array<Run, 2>, kCount> runs_;
};

}  // namespace kairos
