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
    const float farthest = state.hides_from(std::max(hit.dist_begin, hit.dist_end));
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
HWY_INLINE bool ClipEntry(const TimeBins& bins, StackEntry& entry, float& visible_until) {
  if (!TimeBins::clip(Reaching(bins, entry.dist), entry.begin, entry.end)) return false;
  if ((entry.node & kLeafBit) != 0) visible_until = VisibleUntil(bins, TimeBins::touched(entry.begin, entry.end));
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
