// Numbers of 16 bits.
#include "film/half.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace kairos {
namespace {

TEST(Half, IsTheNearest) {
  for (uint32_t bits = 0; bits < 0x10000; ++bits) {
    const auto half = static_cast<uint16_t>(bits);
    if (!is_finite_half(half)) continue;
    ASSERT_EQ(to_half(from_half(half)), half);
    if ((half & 0x7fff) >= 0x7bff) continue;
    const float value = from_half(half), next = from_half(static_cast<uint16_t>(half + 1)), middle = (value + next) / 2;
    ASSERT_EQ(to_half(std::nextafter(middle, value)), half);
    ASSERT_EQ(to_half(std::nextafter(middle, next)), half + 1);
    ASSERT_EQ(to_half(middle) & 1, 0);
  }
  EXPECT_EQ(from_half(0x3c00), 1);
  EXPECT_EQ(from_half(0x0001), 0x1p-24f);
  EXPECT_EQ(from_half(0xc000), -2);
  EXPECT_EQ(from_half(to_half(1e30f)), kMostHalf);
  EXPECT_EQ(from_half(to_half(-INFINITY)), -kMostHalf);
}

}  // namespace
}  // namespace kairos
