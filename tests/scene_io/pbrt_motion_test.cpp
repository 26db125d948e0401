// Transforms that move: ActiveTransform, TransformTimes and instances of what moves.
#include <cmath>
#include <numbers>
#include <random>

#include "pbrt_fixture.h"
#include "scene_io/pbrt/motion.h"
#include "seed.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class PbrtMotion : public PbrtTest {};

TEST_F(PbrtMotion, TranslationGoesEvenly) {
  const Scene scene = load(
      "TransformTimes 1 3 Scale -1 1 1 Camera \"perspective\" \"float shutterclose\" 4 WorldBegin\n"
      "ActiveTransform EndTime Translate 8 0 0 ActiveTransform All Translate 0 0 1\n" +
      std::string(kTriangle));
  const SceneMesh& mesh = scene.meshes[0];
  EXPECT_EQ(positions(mesh, 0)[0], (Vec3d{1, 2, 4}));
  EXPECT_EQ(positions(mesh, 1)[0], (Vec3d{1, 2, 4}));
  EXPECT_EQ(positions(mesh, 1.5)[0], (Vec3d{3, 2, 4}));
  EXPECT_EQ(positions(mesh, 3)[0], (Vec3d{9, 2, 4}));
  EXPECT_EQ(positions(mesh, 7)[0], (Vec3d{9, 2, 4}));
  EXPECT_THAT(mesh.motion->kinks(0, 4), ElementsAre(1, 3));
  EXPECT_THAT(mesh.motion->kinks(1, 3), IsEmpty());
  EXPECT_TRUE(mesh.motion->is_linear_between_kinks());
  EXPECT_FALSE(mesh.motion->is_static(0, 4));
  EXPECT_TRUE(mesh.motion->is_static(0, 1));
  EXPECT_TRUE(mesh.motion->is_static(3, 4));
  EXPECT_EQ(scene.shutter, (std::array<double, 2>{0, 4}));
}

TEST_F(PbrtMotion, RotationGoesAlongTheArc) {
  const Scene scene =
      load_world("ActiveTransform EndTime Rotate 120 0 0 1 ActiveTransform All\n" + std::string(kTriangle));
  EXPECT_FALSE(scene.meshes[0].motion->is_linear_between_kinks());
  for (const double time : {0.0, 0.125, 0.5, 0.7, 1.0}) {
    const double angle = time * 2 * std::numbers::pi / 3, c = std::cos(angle), s = std::sin(angle);
    expect_near(positions(scene.meshes[0], time)[0], {c - 2 * s, s + 2 * c, 3}, 1e-12);
  }
}

/// What pbrt computes: translation, rotation and stretch each on their own.
TEST_F(PbrtMotion, PartsAreInterpolatedApart) {
  const Scene scene = load_world(
      "ActiveTransform StartTime Translate 1 2 3 Rotate 20 1 0 0 Scale 1 2 4\n"
      "ActiveTransform EndTime Translate 5 0 3 Rotate 80 1 0 0 Scale 3 2 1 ActiveTransform All\n" +
      std::string(kTriangle));
  for (const double time : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const double angle = (20 + 60 * time) * std::numbers::pi / 180;
    const Vec3d stretched{(1 + 2 * time) * 1, 2 * 2, (4 - 3 * time) * 3};
    const Vec3d turned{stretched.x, std::cos(angle) * stretched.y - std::sin(angle) * stretched.z,
                       std::sin(angle) * stretched.y + std::cos(angle) * stretched.z};
    expect_near(positions(scene.meshes[0], time)[0], turned + Vec3d{1 + 4 * time, 2 - 2 * time, 3}, 1e-12);
  }
}

TEST_F(PbrtMotion, RandomMatricesAreTakenApartAndPutTogether) {
  const unsigned seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> entry(-3, 3);
  for (int i = 0; i < 200; ++i) {
    Mat4 matrix;
    for (size_t c = 0; c < 4; ++c)
      for (size_t r = 0; r < 3; ++r) matrix.m[c][r] = entry(random);
    if (std::abs(determinant3(matrix)) < 0.1) continue;
    const pbrt::Decomposed parts(matrix);
    const Mat4 again = translation(parts.translation) * rotation(parts.rotation) * parts.stretch;
    for (size_t c = 0; c < 4; ++c)
      for (size_t r = 0; r < 4; ++r) {
        EXPECT_NEAR(again.m[c][r], matrix.m[c][r], 1e-12);
        EXPECT_NEAR(parts.stretch.m[c][r], parts.stretch.m[r][c], 1e-9) << "the stretch turns";
      }
  }
}

TEST_F(PbrtMotion, HalfTurnsAndMirrorsKeepTheirEnds) {
  for (const std::string end : {"Rotate 180 0 1 0", "Rotate 180 1 1 0 Scale 2 2 2", "Scale 1 -1 1 Rotate 40 1 2 3"}) {
    const Scene scene = load_world("ActiveTransform EndTime " + end + " ActiveTransform All\n" + kTriangle);
    const Scene at_rest = load_world(end + "\n" + kTriangle);
    expect_near(positions(scene.meshes[0], 1)[0], positions(at_rest.meshes[0])[0]);
    expect_near(positions(scene.meshes[0], 1 - 1e-9)[0], positions(at_rest.meshes[0])[0], 1e-7);
    expect_near(positions(scene.meshes[0], 1e-9)[0], {1, 2, 3}, 1e-7);
  }
}

TEST_F(PbrtMotion, EqualTimesAreAJump) {
  const Scene scene = load(
      "TransformTimes .5 .5 Scale -1 1 1 Camera \"perspective\" WorldBegin ActiveTransform EndTime "
      "Translate 8 0 0 ActiveTransform All\n" +
      std::string(kTriangle));
  EXPECT_THAT(scene.meshes[0].motion->kinks(0, 1), ElementsAre(0.5));
  EXPECT_EQ(positions(scene.meshes[0], 0.5, Side::before)[0].x, 1);
  EXPECT_EQ(positions(scene.meshes[0], 0.5, Side::after)[0].x, 9);
}

TEST_F(PbrtMotion, InstancesNest) {
  const Scene scene = load_world("ObjectBegin \"inner\" Translate 1 0 0\n" + std::string(kTriangle) +
                                 "ObjectEnd\n"
                                 "ObjectBegin \"outer\" Scale 2 2 2 ObjectInstance \"inner\" ObjectEnd\n"
                                 "AttributeBegin Translate 0 0 100 ObjectInstance \"outer\" AttributeEnd\n"
                                 "AttributeBegin Rotate 90 0 0 1 ObjectInstance \"inner\" AttributeEnd\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(positions(scene.meshes[0])[0], (Vec3d{4, 4, 106}));
  expect_near(positions(scene.meshes[1])[0], {-2, 2, 3});
  EXPECT_TRUE(scene.meshes[0].motion->is_static(0, 1));
  EXPECT_EQ(scene.meshes[0].triangles, scene.meshes[1].triangles);
}

TEST_F(PbrtMotion, MovingInstancesOfWhatMoves) {
  const Scene scene = load_world(
      "ObjectBegin \"o\" ActiveTransform EndTime Translate 4 0 0 ActiveTransform All\n" + std::string(kTriangle) +
      "ObjectEnd ActiveTransform EndTime Rotate 90 0 0 1 ActiveTransform All ObjectInstance \"o\"\n");
  const double turn = std::numbers::pi / 8, c = std::cos(turn), s = std::sin(turn);
  expect_near(positions(scene.meshes[0], 0.25)[0], {2 * c - 2 * s, 2 * s + 2 * c, 3});
  EXPECT_FALSE(scene.meshes[0].motion->is_linear_between_kinks());
}

TEST_F(PbrtMotion, TwoTranslationsWithinAScaleThatMovesAreNotLinear) {
  const std::string object = "ObjectBegin \"o\" ActiveTransform EndTime Translate 4 0 0 ActiveTransform All\n" +
                             std::string(kTriangle) + "ObjectEnd ";
  const auto linear = [&](const std::string& outside) {
    const Scene scene = load_world(object + outside + " ObjectInstance \"o\"\n");
    return scene.meshes[0].motion->is_linear_between_kinks();
  };
  EXPECT_TRUE(linear("Rotate 30 1 2 3 Scale 2 2 1"));
  EXPECT_FALSE(linear("ActiveTransform EndTime Scale 2 2 2 ActiveTransform All"));
}

}  // namespace
}  // namespace kairos
