// Sorting of short lists of numbers without branches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kairos {

/// The most numbers that sort_by_counting takes, and by how many it reads at once.
inline constexpr size_t kCountingSortCount = 192, kCountingSortLanes = 16;

/// order[0] to order[count - 1]: indices of the first `count` of `values`, in ascending order; equal ones stay as they
/// are. The values lie in memory up to the next multiple of kCountingSortLanes, with infinities behind the last. Counts
/// for each value how many are less: n^2 comparisons, 16 at a time with AVX-512, and none that a processor could guess
/// wrong. Infinities and what is not a number must not be among the first `count`.
void sort_by_counting(const float* values, size_t count, uint32_t* order);

}  // namespace kairos
