#include "scene_io/keyframes.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Vec3d position(const VertexMotion& motion, double time) {
  std::vector<Vec3d> out(motion.vertex_count());
  motion.positions(time, Side::after, out);
  return out[0];
}
Vec3f normal(const VertexMotion& motion, double time) {
  std::vector<Vec3f> out(motion.vertex_count());
  motion.normals(time, Side::after, out);
  return out[0];
}
/// One vertex at these positions.
VertexKeys keys(std::vector<double> times, const std::vector<Vec3f>& positions) {
  VertexKeys result{std::move(times), {}, {}};
  for (const Vec3f& p : positions) result.positions.push_back({p});
  return result;
}

TEST(KeyframeMotion, GoesLinearlyBetweenKeysAndHoldsOutside) {
  const KeyframeMotion motion(keys({1, 2, 4}, {{0, 0, 0}, {1, 2, 3}, {5, 2, 3}}));
  EXPECT_EQ(position(motion, -5), (Vec3d{0, 0, 0}));
  EXPECT_EQ(position(motion, 1.25), (Vec3d{0.25, 0.5, 0.75}));
  EXPECT_EQ(position(motion, 2), (Vec3d{1, 2, 3}));
  EXPECT_EQ(position(motion, 3), (Vec3d{3, 2, 3}));
  EXPECT_EQ(position(motion, 9), (Vec3d{5, 2, 3}));
  EXPECT_THAT(motion.kinks(1, 4), ElementsAre(2));
  EXPECT_THAT(motion.kinks(0, 5), ElementsAre(1, 2, 4));
  EXPECT_THAT(motion.kinks(2, 3), IsEmpty());
  EXPECT_TRUE(motion.is_linear_between_kinks());
  EXPECT_FALSE(motion.has_normals());
}

TEST(KeyframeMotion, KeysAreMetExactly) {
  const KeyframeMotion motion(keys({0, 1}, {{1e20f, 0.1f, 3}, {1e-20f, 0.3f, 7}}));
  EXPECT_EQ(position(motion, 0), to_double(Vec3f{1e20f, 0.1f, 3}));
  EXPECT_EQ(position(motion, 1), to_double(Vec3f{1e-20f, 0.3f, 7}));
}

TEST(KeyframeMotion, RestsWhereTheKeysThatMatterAreEqual) {
  const KeyframeMotion motion(keys({0, 1, 2, 3}, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
  EXPECT_TRUE(motion.is_static(1, 2));
  EXPECT_TRUE(motion.is_static(1.2, 1.8));
  EXPECT_TRUE(motion.is_static(-2, 0));
  EXPECT_TRUE(motion.is_static(3, 8));
  EXPECT_TRUE(motion.is_static(0.5, 0.5));
  EXPECT_FALSE(motion.is_static(0.9, 1.5));
  EXPECT_FALSE(motion.is_static(1.5, 2.1));
  EXPECT_FALSE(motion.is_static(-1, 0.1));
  EXPECT_TRUE(KeyframeMotion(keys({0, 1}, {{1, 2, 3}, {1, 2, 3}})).is_static(-10, 10));
  EXPECT_TRUE(KeyframeMotion(keys({0}, {{1, 2, 3}})).is_static(-10, 10));
}

TEST(KeyframeMotion, MatrixEntriesGoLinearly) {
  const TransformKeys transform{{0, 2}, {scaling({1, 1, 1}), translation({4, 0, 0}) * scaling({3, 1, 1})}};
  const KeyframeMotion single(keys({0}, {{1, 1, 0}}), transform);
  EXPECT_EQ(position(single, 1), (Vec3d{4, 1, 0}));  // scale 2, then 2 to the right
  EXPECT_TRUE(single.is_linear_between_kinks());
  EXPECT_FALSE(single.is_static(0, 1));
  EXPECT_TRUE(single.is_static(2, 3));
  EXPECT_THAT(single.kinks(-1, 1), ElementsAre(0));

  const KeyframeMotion both(keys({0, 1}, {{1, 1, 0}, {2, 1, 0}}), transform);
  EXPECT_FALSE(both.is_linear_between_kinks());
  EXPECT_THAT(both.kinks(-1, 3), ElementsAre(0, 1, 2));
  EXPECT_EQ(position(both, 0.5), (Vec3d{1.5 * 1.5 + 1, 1, 0}));

  const KeyframeMotion placed(keys({0, 1}, {{1, 1, 0}, {2, 1, 0}}), {{0}, {translation({0, 5, 0})}});
  EXPECT_TRUE(placed.is_linear_between_kinks());
  EXPECT_EQ(position(placed, 0.5), (Vec3d{1.5, 6, 0}));
}

TEST(KeyframeMotion, NormalsAreInterpolatedAndStayUpright) {
  VertexKeys vertices = keys({0, 1}, {{0, 0, 0}, {0, 0, 0}});
  vertices.normals = {{{1, 0, 0}}, {{0, 1, 0}}};
  EXPECT_FALSE(KeyframeMotion(vertices).is_static(0, 1));
  const auto half = static_cast<float>(std::sqrt(0.5));
  const KeyframeMotion motion(vertices);
  EXPECT_EQ(normal(motion, 0), (Vec3f{1, 0, 0}));
  EXPECT_NEAR(normal(motion, 0.5).x, half, 1e-7);
  EXPECT_NEAR(normal(motion, 0.5).y, half, 1e-7);
  // A slope of 45 degrees, stretched along x, becomes flatter: its normal turns away from x.
  const KeyframeMotion stretched(vertices, {{0}, {scaling({2, 1, 1})}});
  EXPECT_NEAR(normal(stretched, 0.5).x, 1 / std::sqrt(5.0), 1e-7);
  EXPECT_NEAR(normal(stretched, 0.5).y, 2 / std::sqrt(5.0), 1e-7);
}

TEST(KeyframeMotion, MirroringKeepsNormalsOnTheirSide) {
  VertexKeys vertices = keys({0}, {{1, 0, 0}});
  vertices.normals = {{{0.6f, 0.8f, 0}}};
  const KeyframeMotion motion(vertices, {{0}, {scaling({-1, 1, 1})}});
  EXPECT_TRUE(motion.mirrors());
  EXPECT_NEAR(normal(motion, 0).x, -0.6, 1e-7);
  EXPECT_NEAR(normal(motion, 0).y, 0.8, 1e-7);
  EXPECT_FALSE(KeyframeMotion(vertices, {{0}, {scaling({-1, -1, 1})}}).mirrors());
}

TEST(LookAtMotion, InterpolatesWhatItLooksAtThenLooks) {
  const LookAtMotion motion({{0, {0, 0, 5}, {0, 0, 0}, {0, 1, 0}}, {2, {4, 0, 5}, {0, 0, 1}, {0, 2, 0}}}, "camera");
  EXPECT_EQ(motion.at(-1, Side::after), translation({0, 0, 5}));
  EXPECT_EQ(motion.at(1, Side::after), look_at({2, 0, 5}, {0, 0, 0.5}, {0, 1.5, 0}));
  EXPECT_EQ(motion.at(7, Side::after), look_at({4, 0, 5}, {0, 0, 1}, {0, 2, 0}));
  EXPECT_FALSE(motion.is_static(0, 1));
  EXPECT_TRUE(motion.is_static(2, 3));
  EXPECT_THAT(motion.kinks(-1, 3), ElementsAre(0, 2));
}

TEST(LookAtMotion, RefusesToLookNowhere) {
  const Vec3d up{0, 1, 0};
  const auto make = [](std::vector<LookAtKey> given) { LookAtMotion(std::move(given), "camera.keys"); };
  expect_error([&] { make({{0, {1, 2, 3}, {1, 2, 3}, up}}); }, {"camera.keys", "time 0", "no direction"});
  expect_error([&] { make({{0, {0, 5, 0}, {0, 0, 0}, up}}); }, {"no direction"});
  expect_error([&] { make({{0, {0, 0, 1}, {0, 0, 0}, {0, 0, 0}}}); }, {"no direction"});
  // The eye passes through the target on the way; it passes straight above it; up turns over.
  expect_error([&] { make({{0, {0, 0, 1}, {0, 0, 0}, up}, {4, {0, 0, -3}, {0, 0, 0}, up}}); }, {"time 1 "});
  expect_error([&] { make({{0, {0.3, 7, 1}, {0.3, 0, 0}, up}, {1, {0.3, 7, -1}, {0.3, 0, 0}, up}}); }, {"time 0.5 "});
  expect_error([&] { make({{0, {0, 0, 1}, {0, 0, 0}, up}, {1, {0, 0, 1}, {0, 0, 0}, {0, -1, 0}}}); }, {"time 0.5 "});
  EXPECT_NO_THROW(make({{0, {0.01, 7, 1}, {0, 0, 0}, up}, {1, {0.01, 7, -1}, {0, 0, 0}, up}}));
}

}  // namespace
}  // namespace kairos
