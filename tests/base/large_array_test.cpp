// Memory for arrays of many megabytes.
#include "base/large_array.h"

#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

namespace kairos {
namespace {

TEST(LargeArray, IsAlignedToCacheLinesAndToLargePagesWhereItIsLarge) {
  for (const size_t bytes : {size_t{1}, size_t{100}, size_t{1} << 20, (size_t{8} << 20) + 1, size_t{32} << 20}) {
    void* const memory = allocate_large(bytes);
    const auto address = reinterpret_cast<uintptr_t>(memory);
    EXPECT_EQ(address % (bytes > (size_t{8} << 20) ? size_t{2} << 20 : 64), 0u) << bytes;
    std::memset(memory, 1, bytes);
    free_large(memory);
  }
}

TEST(LargeArray, RefusesSizesThatNoMachineHas) {
  EXPECT_THROW(free_large(allocate_large(static_cast<size_t>(-1))), std::bad_alloc);
  EXPECT_THROW(free_large(allocate_large(static_cast<size_t>(-1) / 2)), std::bad_alloc);
  LargeArray<uint64_t> array;
  EXPECT_THROW(array.reserve(static_cast<size_t>(-1) / 4), std::length_error);
}

TEST(LargeArray, KeepsWhatIsInItWhenItGrows) {
  LargeArray<uint32_t> array;
  for (uint32_t i = 0; i < 3000000; ++i) array.push_back(i);
  for (uint32_t i = 0; i < 3000000; ++i) ASSERT_EQ(array[i], i);
  const LargeArray<uint32_t> zeros(1000, 0);
  EXPECT_EQ(zeros[999], 0u);
}

}  // namespace
}  // namespace kairos
