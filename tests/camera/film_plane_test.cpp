// Lenses: where film points lie on the plane in front of the camera, and back.
#include "camera/film_plane.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "camera/camera_rays.h"
#include "camera/pixel_cone.h"
#include "error_matchers.h"
#include "seed.h"

namespace kairos {
namespace {

constexpr Matrix kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

Projection orthographic(int width, int height, double view_height) {
  Projection p;
  p.width = width;
  p.height = height;
  p.orthographic = true;
  p.view_height = view_height;
  return p;
}

/// From camera space to the picture's [-1, 1] x [-1, 1].
Vec2d clip(const Matrix& m, Vec3d p) {
  const auto row = [&](size_t r) { return m[0][r] * p.x + m[1][r] * p.y + m[2][r] * p.z + m[3][r]; };
  return {row(0) / row(3), row(1) / row(3)};
}

TEST(FilmPlane, ShiftAndAspectMoveAndStretchThePicture) {
  Projection p = orthographic(4, 2, 2);
  p.pixel_aspect = 0.5;
  p.shift = {0.25, -0.5};
  const FilmPlane plane(p);
  EXPECT_EQ(plane.at(2, 1), (Vec2d{0.5, -1}));
  EXPECT_EQ(plane.at(0, 0), (Vec2d{-0.5, 0}));
  EXPECT_EQ(plane.at(4, 2), (Vec2d{1.5, -2}));
  EXPECT_EQ(plane.film({1.5, -2}), (Vec2d{4, 2}));
  EXPECT_EQ(plane.pixels_per_unit(), 2);  // pixels are 0.5 wide and 1 high
  EXPECT_DOUBLE_EQ(plane.pixel_side(), std::sqrt(0.5));
  EXPECT_EQ(plane.farthest_corner(), 1.5 * 1.5 + 2 * 2);
}

// The rays of a part of a frame, by whole pixels, are those of the frame.
TEST(FilmPlane, AShiftShowsAPartOfALargerFrame) {
  const FilmPlane whole(orthographic(64, 32, 4));
  Projection part = orthographic(16, 8, 1);
  part.shift = {(40 + 8 - 32) / 8.0, (16 - 4 - 4) / 8.0};  // pixels [40, 56) x [4, 12)
  const FilmPlane shifted(part);
  for (int y = 0; y <= 16; ++y)
    for (int x = 0; x <= 32; ++x)
      EXPECT_EQ(shifted.at(x / 2.0, y / 2.0), whole.at(40 + x / 2.0, 4 + y / 2.0)) << x << ' ' << y;
}

TEST(FilmPlane, FollowsAnyMatrix) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const bool flat = i % 2 == 0;
    const double w = 1 + uniform(random) / 2;
    Matrix m{};
    m[0] = {2 + uniform(random), uniform(random), uniform(random), 0};
    m[1] = {uniform(random), -2 + uniform(random), uniform(random), 0};
    m[2] = {flat ? 0 : uniform(random), flat ? 0 : uniform(random), -1, flat ? 0 : -w};
    m[3] = {flat ? uniform(random) : 0, flat ? uniform(random) : 0, -0.1, flat ? w : 0};
    Projection p;
    p.width = 200;
    p.height = 50;
    p.matrix = m;
    check_lens(p, "camera");
    const FilmPlane plane(p);
    EXPECT_EQ(plane.orthographic(), flat);
    const Vec2d film{100 + 100 * uniform(random), 25 + 25 * uniform(random)};
    const Vec2d point = plane.at(film.x, film.y);
    const double depth = flat ? 7 : 3;  // rays lead to the same film point at every depth
    const Vec2d seen = flat ? clip(m, {point.x, point.y, -depth}) : clip(m, {point.x * depth, point.y * depth, -depth});
    EXPECT_NEAR((seen.x + 1) * 100, film.x, 1e-10);
    EXPECT_NEAR((1 - seen.y) * 25, film.y, 1e-10);
    const Vec2d back = plane.film(point);
    EXPECT_NEAR(back.x, film.x, 1e-10);
    EXPECT_NEAR(back.y, film.y, 1e-10);
    // A step in any direction leads over at most so many pixels, and in some direction over about as many.
    double most = 0;
    for (int k = 0; k < 3600; ++k) {
      const double angle = k * 0.0017453292519943296;
      const Vec2d to = plane.film({point.x + std::cos(angle), point.y + std::sin(angle)});
      most = std::max(most, std::hypot(to.x - back.x, to.y - back.y));
    }
    EXPECT_LE(most, plane.pixels_per_unit() * (1 + 1e-12));
    EXPECT_GT(most, plane.pixels_per_unit() * (1 - 1e-5));
    const Vec2d right = plane.at(1, 0), down = plane.at(0, 1), corner = plane.at(0, 0);
    const double area =
        std::abs((right.x - corner.x) * (down.y - corner.y) - (right.y - corner.y) * (down.x - corner.x));
    EXPECT_NEAR(plane.pixel_side() * plane.pixel_side(), area, 1e-12);
  }
}

TEST(FilmPlane, AMatrixThatSaysWhatALensSaysGivesItsRays) {
  Projection lens;
  lens.vfov = 0.9;
  lens.pixel_aspect = 1.25;
  lens.shift = {0.25, -0.125};
  const double half = std::tan(0.45), half_width = half * 960 / 540 * 1.25;
  Projection given;
  given.matrix = Matrix{{{1 / half_width, 0, 0, 0},
                         {0, 1 / half, 0, 0},
                         {2 * half * 0.25 / half_width, 2 * half * -0.125 / half, -1, -1},
                         {0, 0, -0.2, 0}}};
  const CameraRays a(lens), b(given);
  const FilmPlane from(lens), to(given);
  EXPECT_NEAR(from.pixels_per_unit(), to.pixels_per_unit(), 1e-9);
  EXPECT_NEAR(from.farthest_corner(), to.farthest_corner(), 1e-12);
  EXPECT_NEAR(PixelCone(lens).spread(), PixelCone(given).spread(), 1e-15);
  for (const double x : {0.0, 17.5, 960.0})
    for (const double y : {0.0, 33.25, 540.0}) {
      EXPECT_FLOAT_EQ(a.at(x, y).direction.x, b.at(x, y).direction.x);
      EXPECT_FLOAT_EQ(a.at(x, y).direction.y, b.at(x, y).direction.y);
      EXPECT_EQ(b.at(x, y).direction.z, -1);
    }
}

TEST(FilmPlane, LensesThatShowNothingAreRefused) {
  const auto refused = [](const auto& change, const std::string& word) {
    Lens lens;
    change(lens);
    expect_error([&] { check_lens(lens, "camera 'a'"); }, {"camera 'a'", word});
  };
  const auto refused_matrix = [&](size_t column, size_t row, double entry, const std::string& word) {
    for (const bool flat : {false, true}) {
      if (flat != (column == 2 && row < 2)) continue;
      Matrix m = kIdentity;
      if (!flat) m[2][3] = -1, m[3][3] = 0;
      m[column][row] = entry;
      refused([&](Lens& lens) { lens.matrix = m; }, word);
    }
  };
  refused([](Lens& l) { l.vfov = 3.2; }, "field of view");
  refused([](Lens& l) { l.vfov = NAN; }, "field of view");
  refused([](Lens& l) { l.orthographic = true, l.view_height = 0; }, "view height");
  refused([](Lens& l) { l.pixel_aspect = 0; }, "pixel aspect");
  refused([](Lens& l) { l.pixel_aspect = NAN; }, "pixel aspect");
  refused([](Lens& l) { l.shift[1] = INFINITY; }, "shift");
  refused_matrix(0, 0, NAN, "not finite");
  refused_matrix(0, 0, 0, "on a line");
  refused_matrix(0, 3, 1, "row");
  refused_matrix(3, 3, 1, "row");
  refused_matrix(2, 3, 1, "row");
  refused_matrix(3, 0, 1, "eye beside the origin");
  refused_matrix(2, 1, 1, "not along -z");
}

}  // namespace
}  // namespace kairos
