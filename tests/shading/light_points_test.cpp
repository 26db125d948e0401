// Where on lights shading samples look.
#include "shading/light_points.h"

#include <array>

#include <gtest/gtest.h>

namespace kairos {
namespace {

TEST(LightPoints, AreSpreadEvenlyInEachDimensionAndOverTime) {
  for (const uint64_t seed : {1u, 2u, 77u}) {
    std::array<std::array<int, 64>, 3> strata{};
    for (uint32_t i = 0; i < 64; ++i) {
      const auto point = light_point(SampleKey{seed, i}.branch(5));
      for (size_t d = 0; d < 3; ++d) ++strata[d][static_cast<size_t>(point[d] * 64)];
    }
    for (const auto& dimension : strata)
      for (const int count : dimension) EXPECT_EQ(count, 1);
  }
  EXPECT_NE(light_point({1, 0}), light_point({2, 0}));
}

}  // namespace
}  // namespace kairos
