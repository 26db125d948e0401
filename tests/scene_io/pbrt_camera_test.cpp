// What the camera sees, and which way round.
#include <cmath>
#include <numbers>

#include "pbrt_fixture.h"

namespace kairos {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class PbrtCamera : public PbrtTest {
 protected:
  static Vec3d seen(const Scene& scene, Vec3d world, double time = 0) {
    return transform_point(inverse_affine(scene.cameras.at(0).motion->at(time, Side::after)), world);
  }
  double tangent(const std::string& camera, const std::string& film) const {
    const Scene scene = load("Camera \"perspective\" " + camera + "\nFilm \"image\" " + film + "\nWorldBegin\n");
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    return std::tan(scene.cameras.at(0).vfov / 2);
  }
};

/// pbrt's camera space has x to the right, y up and z forward: what it sees at (1, 0.5, 4) must be at (1, 0.5, -4).
TEST_F(PbrtCamera, PicturesAreNotMirrored) {
  for (const std::string mirror : {"", "Scale -1 1 1\n"}) {
    const Scene scene =
        load("Translate 0 0 5\nRotate 30 0 1 0\n" + mirror + "Camera \"perspective\"\nWorldBegin\n" + mirror +
             "Rotate -30 0 1 0\nTranslate 0 0 -5\n" + "Shape \"trianglemesh\" \"point P\" [1 0.5 4 0 0 4 0 1 4]\n");
    expect_near(seen(scene, positions(scene.meshes[0])[0]), {1, 0.5, -4});
    EXPECT_NEAR(determinant3(scene.cameras[0].motion->at(0, Side::after)), 1, 1e-12);
  }
}

TEST_F(PbrtCamera, FieldOfViewIsOfTheShorterSide) {
  const std::string wide = "\"integer xresolution\" 200 \"integer yresolution\" 100 ";
  const std::string tall = "\"integer xresolution\" 100 \"integer yresolution\" 200 ";
  const double half = std::tan(20 * kDegree);
  EXPECT_NEAR(tangent("\"float fov\" [40]", wide), half, 1e-12);
  EXPECT_NEAR(tangent("\"float fov\" [40]", tall), 2 * half, 1e-12);
  EXPECT_NEAR(tangent("\"float halffov\" [20]", tall), 2 * half, 1e-12);
  EXPECT_NEAR(tangent("\"float fov\" 40 \"float frameaspectratio\" .5", tall), 2 * half, 1e-12);
  EXPECT_NEAR(tangent("\"float fov\" [40] \"float screenwindow\" [-3 3 -1.5 1.5]", wide), 1.5 * half, 1e-12);
  EXPECT_NEAR(tangent("", "\"string filename\" \"x.exr\""), 1, 1e-12) << "90 degrees, 1280x720";
}

TEST_F(PbrtCamera, FilmGivesThePictureSize) {
  EXPECT_EQ(
      load("Film \"rgb\" \"integer xresolution\" 320 \"integer yresolution\" 240 Camera \"perspective\"").image_size,
      (std::array<int, 2>{320, 240}));
  EXPECT_EQ(load("Camera \"perspective\" WorldBegin").image_size, (std::array<int, 2>{1280, 720}));
}

TEST_F(PbrtCamera, WindowsThatDoNotFitAreReported) {
  using testing::ElementsAre;
  using testing::HasSubstr;
  const std::string film = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100\n";
  EXPECT_THAT(load(film + "Camera \"perspective\" \"float screenwindow\" [0 2 -1 1]").warnings,
              ElementsAre(HasSubstr("scene.pbrt:2: the screen window is not in the middle")));
  EXPECT_THAT(load(film + "Camera \"perspective\" \"float screenwindow\" [-2 2 -1 1]").warnings,
              ElementsAre(HasSubstr("shape is not the picture's")));
}

TEST_F(PbrtCamera, OrthographicHeightIsTheScreenWindows) {
  const std::string film = "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n";
  const Scene plain = load(film + "Camera \"orthographic\"\nWorldBegin\n");
  EXPECT_TRUE(plain.cameras.at(0).orthographic);
  EXPECT_DOUBLE_EQ(plain.cameras[0].view_height, 2);
  EXPECT_DOUBLE_EQ(
      load(film + "Scale .5 .5 .5 Camera \"orthographic\" \"float screenwindow\" [-6 6 -3 3]").cameras[0].view_height,
      12);
}

TEST_F(PbrtCamera, MovesWithBothOfItsTransforms) {
  const Scene scene = load(
      "TransformTimes 0 2 Scale -1 1 1 LookAt 0 0 0 0 0 1 0 1 0\n"
      "ActiveTransform EndTime Identity Scale -1 1 1 Rotate -90 0 1 0 ActiveTransform All\n"
      "Camera \"perspective\" \"float shutteropen\" .5 \"float shutterclose\" 1.5 WorldBegin\n" +
      std::string(kTriangle));
  EXPECT_EQ(scene.shutter, (std::array<double, 2>{0.5, 1.5}));
  EXPECT_EQ(positions(scene.meshes[0])[0], (Vec3d{1, 2, 3})) << "the world starts at rest";
  expect_near(seen(scene, {0, 0, 1}, 0), {0, 0, -1});
  // Halfway it looks halfway between z and its end, the x axis.
  const Vec3d forward{std::sin(45 * kDegree), 0, std::cos(45 * kDegree)};
  expect_near(seen(scene, forward, 1), {0, 0, -1});
  expect_near(seen(scene, {1, 0, 0}, 2), {0, 0, -1});
  EXPECT_FALSE(scene.cameras[0].motion->is_static(0.5, 1.5));
}

TEST_F(PbrtCamera, AnInstantIsAStillFrame) {
  const Scene scene = load("Camera \"perspective\" \"float shutteropen\" 3 \"float shutterclose\" 3");
  EXPECT_EQ(*scene.shutter, (std::array<double, 2>{3, 3}));
}

TEST_F(PbrtCamera, NonsenseIsRefused) {
  refuse("\nCamera \"perspective\" \"float fov\" 180", {"scene.pbrt:2", "fov"});
  refuse("Camera \"perspective\" \"float fov\" 0", {"fov"});
  refuse("Camera \"perspective\" \"float frameaspectratio\" 0", {"frameaspectratio"});
  refuse("Camera \"perspective\" \"float screenwindow\" [1 -1 0 1]", {"screenwindow"});
  refuse("Camera \"perspective\" \"float shutterclose\" 1e20", {"shutter"});
  refuse("Scale 0 1 1 Camera \"perspective\"", {"inverted"});
  refuse("Film \"image\" \"integer xresolution\" 0", {"picture"});
  refuse("Film \"image\" \"integer xresolution\" 70000", {"picture"});
}

}  // namespace
}  // namespace kairos
