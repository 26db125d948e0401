#include "film/pixel_sum.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kairos {
namespace {

ShadedSegment piece(float begin, float end, Vec3f colour, uint32_t mesh, float dist = 1) {
  ShadedSegment s;
  s.begin = begin;
  s.end = end;
  s.colour = colour;
  s.mesh = mesh;
  s.dist_begin = dist;
  s.dist_end = dist + 1;
  return s;
}

TEST(PixelSum, WeighsByDurationAndFillsTheRestWithBackground) {
  PixelSum sum({0, 0, 4}, true);
  const ShadedSegment first[] = {piece(0, 0.25f, {1, 0, 0}, 7), piece(0.5f, 0.75f, {0, 2, 0}, 2, 0.5f)};
  sum.add({ShadedRay::Kind::tc, first, 2});
  sum.add({ShadedRay::Kind::tc, {}, 0});
  EXPECT_EQ(sum.colour(), (Vec3f{0.125f, 0.25f, 3}));
  EXPECT_EQ(sum.coverage(), 0.25f);
  EXPECT_EQ(sum.depth(), 0.5f);
  EXPECT_EQ(sum.visibility_segments(), 1);
  EXPECT_EQ(sum.mesh_id(), 3u) << "of equals the lowest index, plus one";
}

TEST(PixelSum, ADiscreteSampleCountsAsAWholeRay) {
  PixelSum sum({0, 0, 1}, true);
  const ShadedSegment seen = piece(0.3f, 0.3f, {1, 1, 0}, 0);
  sum.add({ShadedRay::Kind::discrete, {&seen, 1}, 1});
  sum.add({ShadedRay::Kind::discrete, {}, 0});
  EXPECT_EQ(sum.colour(), (Vec3f{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(sum.coverage(), 0.5f);
}

TEST(PixelSum, EmptyAndClearedHaveNothing) {
  PixelSum sum({1, 1, 1}, true);
  const ShadedSegment seen = piece(0, 1, {1, 1, 0}, 0);
  sum.add({ShadedRay::Kind::tc, {&seen, 1}, 1});
  sum.clear();
  EXPECT_EQ(sum.colour(), Vec3f{});
  EXPECT_EQ(sum.coverage(), 0);
  EXPECT_EQ(sum.mesh_id(), 0u);
  EXPECT_TRUE(std::isinf(sum.depth()));
}

}  // namespace
}  // namespace kairos
