// The order of short lists, for every instruction set that this machine has.
#include "kernels/counting_sort.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "soup.h"

namespace kairos {
namespace {

std::vector<uint32_t> order_of(std::vector<float> values) {
  std::vector<uint32_t> order(values.size());
  const size_t count = values.size();
  values.resize(count + kCountingSortLanes, std::numeric_limits<float>::infinity());
  sort_by_counting(values.data(), count, order.data());
  return order;
}

TEST(CountingSort, IsAStableSortOfListsOfAnyLength) {
  const uint32_t seed = test::seed();
  for (const int64_t target : {HWY_SSE4, HWY_AVX2, HWY_AVX3, HWY_NEON}) {
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    std::mt19937 random(seed);
    for (size_t count = 0; count <= kCountingSortCount; ++count) {
      std::vector<float> values(count);
      // Few different values, so that many are equal.
      for (float& value : values) value = static_cast<float>(random() % (1 + count / 2)) / 64;
      std::vector<uint32_t> expected(count);
      std::iota(expected.begin(), expected.end(), 0u);
      std::stable_sort(expected.begin(), expected.end(), [&](uint32_t a, uint32_t b) { return values[a] < values[b]; });
      EXPECT_EQ(order_of(values), expected) << count << " values, target " << target << ", seed " << seed;
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

}  // namespace
}  // namespace kairos
