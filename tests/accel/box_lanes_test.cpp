// What the builder computes with: boxes as vectors, their cost, and what splits sort by.
#include "accel/box_lanes.h"

#include <random>

#include <gtest/gtest.h>

#include "soup.h"

namespace kairos {
namespace {

/// A box from its bounds: [key][axis].
BoxLanes make_box(const double (&lower)[2][3], const double (&upper)[2][3]) {
  BoxLanes box = BoxLanes::empty();
  for (size_t key = 0; key < 2; ++key)
    for (int axis = 0; axis < 3; ++axis) {
      box.bound[2 * key][axis] = static_cast<float>(lower[key][axis]);
      box.bound[2 * key + 1][axis] = static_cast<float>(-upper[key][axis]);
    }
  return box;
}

TEST(BoxLanes, CostIsTheSweptSurfaceAndHalfOfTheMeanBoxs) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int round = 0; round < 1000; ++round) {
    double lower[2][3], upper[2][3], edge[3], move[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int key = 0; key < 2; ++key) {
        lower[key][axis] = 4 * uniform(random) - 2;
        upper[key][axis] = lower[key][axis] + uniform(random);
      }
      edge[axis] = (upper[0][axis] - lower[0][axis] + upper[1][axis] - lower[1][axis]) / 2;
      move[axis] = (upper[1][axis] + lower[1][axis] - upper[0][axis] - lower[0][axis]) / 2;
    }
    // Half of the surface: one of each pair of parallelograms, over all pairs of generators.
    const Vec3d generator[4] = {{edge[0], 0, 0}, {0, edge[1], 0}, {0, 0, edge[2]}, {move[0], move[1], move[2]}};
    double swept = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) swept += length(cross(generator[i], generator[j]));
    const double box = edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0];
    BoxLanes lanes = make_box(lower, upper);
    for (Lanes& bound : lanes.bound) bound[3] = 1e30f;  // no part of the box
    EXPECT_NEAR(lanes.cost() / 4, swept + box / 2, 1e-5 * (swept + box));
  }
}

TEST(BoxLanes, IncludeIsTheUnion) {
  BoxLanes box = BoxLanes::empty();
  box.include(make_box({{0, 1, 2}, {3, 4, 5}}, {{1, 2, 3}, {4, 5, 6}}));
  box.include(make_box({{-1, 1.5, 2}, {3, 3, 7}}, {{0, 9, 2}, {4, 8, 8}}));
  const float lower[2][3] = {{-1, 1, 2}, {3, 3, 5}}, upper[2][3] = {{1, 9, 3}, {4, 8, 8}};
  for (int key = 0; key < 2; ++key)
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(box.lower(key, axis), lower[key][axis]);
      EXPECT_EQ(box.upper(key, axis), upper[key][axis]);
    }
}

TEST(BoxLanes, SortsByTwiceTheCentreAndTwiceItsMotion) {
  const SortValues values(make_box({{0, 1, 2}, {3, 4, -5}}, {{1, 2, 3}, {4, 7, -3}}));
  const float place[4] = {4, 7, -1.5f, 0}, velocity[4] = {6, 8, -13, 0};
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(values.place[lane], place[lane]) << lane;
    EXPECT_EQ(values.velocity[lane], velocity[lane]) << lane;
  }
}

TEST(BoxLanes, PrimitivesKeepTheirIdsBesideTheirBoxes) {
  Primitive primitive{make_box({{0, 1, 2}, {3, 4, 5}}, {{1, 2, 3}, {4, 5, 6}})};
  for (const TriangleId id : {TriangleId{0, 0}, TriangleId{7, 0x7fffffff}, TriangleId{0xfffffffe, 0x7f800001}}) {
    primitive.set_id(id);
    const Primitive copy = primitive;
    EXPECT_EQ(copy.id().mesh, id.mesh);
    EXPECT_EQ(copy.id().triangle, id.triangle);
    EXPECT_EQ(copy.box.lower(1, 2), 5);
    EXPECT_EQ(copy.box.upper(0, 0), 1);
  }
}

}  // namespace
}  // namespace kairos
