// What runs over all bins of a ray, and what is done with a hit. Compiled once per instruction set; see trace_simd.cpp.

#if defined(KAIROS_TIME_BINS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_TIME_BINS_INL_H
#undef KAIROS_TIME_BINS_INL_H
#else
#define KAIROS_TIME_BINS_INL_H
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "kernels/node_test-inl.h"
#include "kernels/ray_state.h"
#include "kernels/time_bins.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

using BinsTag = hn::CappedTag<float, TimeBins::kCount>;

/// TimeBins::reaching.
HWY_INLINE TimeBins::Mask Reaching(const TimeBins& bins, float dist) {
  const BinsTag d;
  TimeBins::Mask mask = 0;
  for (size_t bin = 0; bin < TimeBins::kCount; bin += hn::Lanes(d))
    mask |= MaskBits(d, hn::Ge(hn::Load(d, bins.hidden_behind() + bin), hn::Set(d, dist))) << bin;
  return mask;
}

/// Lanes whose bit is set.
template <class D>
HWY_INLINE hn::Mask<D> LanesOf(D d, uint32_t bits) {
  const uint8_t bytes[8] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

/// TimeBins::visible_until.
HWY_INLINE float VisibleUntil(const TimeBins& bins, TimeBins::Mask mask) {
  const BinsTag d;
  auto farthest = hn::Zero(d);
  for (size_t bin = 0; bin < TimeBins::kCount; bin += hn::Lanes(d))
    farthest = hn::Max(farthest, hn::IfThenElseZero(LanesOf(d, mask >> bin), hn::Load(d, bins.hidden_behind() + bin)));
  return hn::GetLane(hn::MaxOfLanes(d, farthest));
}

/// TimeBins::close.
HWY_INLINE void CloseBins(TimeBins& bins, TimeBins::Mask mask, float dist) {
  const BinsTag d;
  for (size_t bin = 0; bin < TimeBins::kCount; bin += hn::Lanes(d)) {
    float* hidden = bins.hidden_behind() + bin;
    const auto before = hn::Load(d, hidden);
    hn::Store(hn::IfThenElse(LanesOf(d, mask >> bin), hn::Min(before, hn::Set(d, dist)), before), d, hidden);
  }
}

/// RayState::add where RayState::takes_whole. touched, filled: of its bins. True when
/// it closes a bin.
HWY_INLINE bool AddWhole(RayState& state, const Segment& hit, TimeBins::Mask touched, TimeBins::Mask filled) {
  bool closes = false;
  if (state.culls()) {
    if ((Reaching(state.bins, std::min(hit.dist_begin, hit.dist_end)) & touched) == 0) return false;
    const float farthest = std::max(hit.dist_begin, hit.dist_end);
    if (filled != 0) CloseBins(state.bins, filled, farthest);
    closes = filled != 0;
    if (touched != filled) closes |= state.bins.grow_runs(touched & ~filled, hit.begin, hit.end, farthest);
  }
  state.hits.push_back(hit);
  return closes;
}

/// RayState::add.
HWY_INLINE void AddHit(RayState& state, const Segment& hit) {
  if (!state.takes_whole(hit.mesh)) return state.add(hit);
  if (hit.begin < hit.end && state.shows(hit))
    AddWhole(state, hit, TimeBins::touched(hit.begin, hit.end), TimeBins::filled(hit.begin, hit.end));
}

/// Takes from a stack entry's time what is hidden; false when nothing remains. visible_until: the farthest that what is
/// in the entry, if it is a leaf, can be and still be seen.
HWY_INLINE bool ClipEntry(const TimeBins& bins, const Tree<kMovingKeys>& tree, StackEntry& entry,
                          float& visible_until) {
  // Bins are in shutter time. Rounding may only widen the interval.
  const bool whole_shutter = tree.time_begin == 0 && tree.time_end == 1;
  float begin = entry.begin, end = entry.end;
  if (!whole_shutter) {
    begin = std::max(tree.time_begin, to_shutter_time(begin, tree.time_begin, tree.time_end) - kTimeSnap);
    end = std::min(tree.time_end, to_shutter_time(end, tree.time_begin, tree.time_end) + kTimeSnap);
  }
  if (!TimeBins::clip(Reaching(bins, entry.dist), begin, end)) return false;
  if (whole_shutter) {
    entry.begin = begin;
    entry.end = end;
  } else {
    const float inv_span = 1 / (tree.time_end - tree.time_begin);
    entry.begin = std::max(entry.begin, (begin - tree.time_begin) * inv_span - kTimeSnap);
    entry.end = std::min(entry.end, (end - tree.time_begin) * inv_span + kTimeSnap);
  }
  if ((entry.node & kLeafBit) != 0) visible_until = VisibleUntil(bins, TimeBins::touched(begin, end));
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
