#include "kernels/counting_sort.h"

#include <algorithm>

#include "kernels/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/counting_sort.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void SortByCounting(const float* HWY_RESTRICT values, size_t count, uint32_t* HWY_RESTRICT order) {
  const hn::CappedTag<float, kCountingSortLanes> d;
  uint8_t equals[kCountingSortCount];  // [place]: how many equal values have been put there or behind so far
  std::fill_n(equals, count, uint8_t{0});
  for (size_t i = 0; i < count; ++i) {
    const auto value = hn::Set(d, values[i]);
    size_t less = 0;
    for (size_t j = 0; j < count; j += hn::Lanes(d)) less += hn::CountTrue(d, hn::Lt(hn::LoadU(d, values + j), value));
    order[less + equals[less]++] = static_cast<uint32_t>(i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kairos {

HWY_EXPORT(SortByCounting);

void sort_by_counting(const float* values, size_t count, uint32_t* order) {
  HWY_DYNAMIC_DISPATCH(SortByCounting)(values, count, order);
}

}  // namespace kairos
#endif
