#include "scene_io/triangulate.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "math/transform.h"
#include "seed.h"

namespace kairos {
namespace {

std::vector<Triangle> triangulate(const std::vector<Vec3f>& points) {
  std::vector<Triangle> out;
  EXPECT_TRUE(triangulate_polygon(points, out));
  return out;
}

Vec3d vector_area(Vec3f a, Vec3f b, Vec3f c) {
  return cross(to_double(b) - to_double(a), to_double(c) - to_double(a)) * 0.5;
}

TEST(Triangulate, FewerThanThreePointsGiveNothing) {
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST(Triangulate, ConvexPolygonIsAFanAroundItsFirstCorner) {
  const std::vector<Triangle> expected{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(triangulate({{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {1, 3, 0}, {-1, 1, 0}}), expected);
}

TEST(Triangulate, ArrowheadIsCutAtItsReflexCorner) {
  // Corner 1 is reflex: the fan around corner 0 would reach outside.
  const std::vector<Vec3f> points{{0, 2, 0}, {0, 1, 0}, {2, 0, 0}, {-2, 0, 0}};
  double area = 0;
  for (const Triangle& t : triangulate(points)) {
    EXPECT_TRUE(t[0] == 1 || t[1] == 1 || t[2] == 1);
    area += length(vector_area(points[t[0]], points[t[1]], points[t[2]]));
  }
  EXPECT_DOUBLE_EQ(area,
                   length(vector_area(points[0], points[1], points[2]) + vector_area(points[0], points[2], points[3])));
}

TEST(Triangulate, PentagramWithoutPlaneAndNotFiniteStillGiveTheirCount) {
  std::vector<Vec3f> star;
  for (int i = 0; i < 5; ++i) {
    const auto angle = static_cast<float>(i * 4 * std::numbers::pi / 5);
    star.push_back({std::cos(angle), std::sin(angle), 0});
  }
  EXPECT_EQ(triangulate(star).size(), 3u);
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).size(), 2u);
  EXPECT_EQ(triangulate({{NAN, 0, 0}, {1, 0, 0}, {2, INFINITY, 0}, {3, 0, 0}}).size(), 2u);
}

/// Random simple polygons (seen from a point inside, each direction meets the outline once) in random planes: the
/// triangles cover the area once, all of them facing the polygon's way, each corner pair of the outline used once.
TEST(Triangulate, RandomPolygonsKeepTheirAreaAndOutline) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int round = 0; round < 2000; ++round) {
    const int corners = 3 + static_cast<int>(random() % 30);
    const Mat4 plane = rotation(normalize(
        Quaternion{uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5}));
    std::vector<Vec3f> points;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.8 * uniform(random)) / corners, radius = 0.1 + uniform(random);
      points.push_back(to_float(transform_point(plane, {radius * std::cos(angle), radius * std::sin(angle), 0.5})));
    }
    const std::vector<Triangle> triangles = triangulate(points);
    ASSERT_EQ(triangles.size(), points.size() - 2);
    Vec3d whole, parts;
    double absolute = 0;
    for (size_t i = 1; i + 1 < points.size(); ++i) whole += vector_area(points[0], points[i], points[i + 1]);
    std::vector<int> outline(points.size(), 0);
    for (const Triangle& t : triangles) {
      const Vec3d area = vector_area(points[t[0]], points[t[1]], points[t[2]]);
      parts += area;
      absolute += length(area);
      for (int k = 0; k < 3; ++k)
        if (t[(k + 1) % 3] == (t[k] + 1) % points.size()) ++outline[t[k]];
    }
    ASSERT_NEAR(length(whole - parts), 0, 1e-9);
    ASSERT_NEAR(absolute, length(whole), 1e-6);  // float corners are not exactly in one plane
    for (const int uses : outline) ASSERT_EQ(uses, 1);
  }
}

TEST(Triangulate, HugeConcavePolygonIsReported) {
  std::vector<Vec3f> comb;
  for (int i = 0; i <= 600; ++i) comb.push_back({static_cast<float>(i), i % 2 ? 5.0f : 1.0f, 0});
  comb.push_back({600, 0, 0});
  comb.push_back({0, 0, 0});
  std::vector<Triangle> out;
  EXPECT_FALSE(triangulate_polygon(comb, out));
  EXPECT_EQ(out.size(), comb.size() - 2);
}

}  // namespace
}  // namespace kairos
