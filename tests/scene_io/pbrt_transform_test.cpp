// Transform statements: where a point ends up.
#include <cmath>

#include "pbrt_fixture.h"
#include "scene_io/pbrt/transform.h"

namespace kairos {
namespace {

class PbrtTransform : public PbrtTest {
 protected:
  Vec3d placed(const std::string& statements) const {
    return positions(load_world(statements + "\n" + kTriangle).meshes.at(0)).at(0);
  }
};

TEST_F(PbrtTransform, EachStatementIsAppliedInsideTheOnesBefore) {
  EXPECT_EQ(placed(""), (Vec3d{1, 2, 3}));
  EXPECT_EQ(placed("Translate 10 20 30"), (Vec3d{11, 22, 33}));
  EXPECT_EQ(placed("Scale 2 3 -4"), (Vec3d{2, 6, -12}));
  EXPECT_EQ(placed("Translate 10 0 0 Scale 2 1 1"), (Vec3d{12, 2, 3}));
  EXPECT_EQ(placed("Scale 2 1 1 Translate 10 0 0"), (Vec3d{22, 2, 3}));
  EXPECT_EQ(placed("Scale 2 2 2 Identity"), (Vec3d{1, 2, 3}));
  expect_near(placed("Rotate 90 0 0 1"), {-2, 1, 3});
  expect_near(placed("Rotate 90 0 2 0"), {3, 2, -1});
  expect_near(placed("Rotate -90 1 0 0"), {1, 3, -2});
  expect_near(placed("Rotate 120 1 1 1"), {3, 1, 2});
}

TEST_F(PbrtTransform, MatricesAreWrittenColumnAfterColumn) {
  EXPECT_EQ(placed("Transform [0 1 0 0  -1 0 0 0  0 0 1 0  10 20 30 1]"), (Vec3d{8, 21, 33}));
  EXPECT_EQ(placed("Translate 5 0 0 Transform [1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1]"), (Vec3d{2, 3, 4}));
  EXPECT_EQ(placed("Translate 5 0 0 ConcatTransform 1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1"), (Vec3d{7, 3, 4}));
  EXPECT_EQ(placed("Transform [1 0 0 0 0 1 0 0 0 0 1 0 2 2 2 2]"), (Vec3d{1.5, 2, 2.5}));
}

TEST_F(PbrtTransform, LookAtTakesTheTargetToTheZAxis) {
  const Mat4 m = pbrt::pbrt_look_at({1, 2, 3}, {4, 2, 3}, {0, 1, 0});
  expect_near(transform_point(m, {1, 2, 3}), {0, 0, 0});
  expect_near(transform_point(m, {4, 2, 3}), {0, 0, 3});
  expect_near(transform_vector(m, {0, 1, 0}), {0, 1, 0});
  expect_near(transform_vector(m, {0, 0, -1}), {1, 0, 0});  // the right of who looks along x in a left-handed world
  EXPECT_NEAR(determinant3(m), 1, 1e-12);
}

TEST_F(PbrtTransform, BlocksRestoreWhatTheyFound) {
  EXPECT_EQ(placed("AttributeBegin Translate 1 0 0 AttributeEnd"), (Vec3d{1, 2, 3}));
  EXPECT_EQ(placed("Translate 1 0 0 TransformBegin Scale 9 9 9 TransformEnd"), (Vec3d{2, 2, 3}));
  // The transform, but not the material.
  const Scene scene = load_world("TransformBegin Scale 2 2 2 Material \"matte\" \"rgb Kd\" [1 0 0] TransformEnd\n" +
                                 std::string(kTriangle) + "AttributeBegin Material \"matte\" \"rgb Kd\" [0 1 0]\n" +
                                 "AttributeEnd\n" + kTriangle);
  EXPECT_EQ(positions(scene.meshes[1])[0], (Vec3d{1, 2, 3}));
  EXPECT_EQ(scene.materials[scene.meshes[1].material].base_color, (Vec3f{1, 0, 0}));
}

TEST_F(PbrtTransform, NamedCoordinateSystems) {
  EXPECT_EQ(placed("Translate 1 0 0 CoordinateSystem \"here\" Scale 5 5 5 CoordSysTransform \"here\""),
            (Vec3d{2, 2, 3}));
  EXPECT_EQ(placed("Scale 5 5 5 CoordSysTransform \"world\""), (Vec3d{1, 2, 3}));
  // Camera space: x to the right, z forward.
  const Scene scene =
      load("Translate 0 0 7 Scale -1 1 1 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\"\n" +
           std::string(kTriangle));
  EXPECT_EQ(positions(scene.meshes[0])[0], (Vec3d{-1, 2, -4}));
}

TEST_F(PbrtTransform, MirrorsAndReverseOrientationTurnTriangles) {
  const std::string with_normals =
      "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1 0 0 1 0 "
      "0 1]";
  const auto normal = [&](const std::string& statements) {
    const Scene scene = load_world(statements + " " + with_normals);
    EXPECT_GT(dot(geometric_normal(scene.meshes[0]), to_double(normals(scene.meshes[0])[0])), 0) << statements;
    return normals(scene.meshes[0])[0];
  };
  EXPECT_EQ(normal(""), (Vec3f{0, 0, 1}));
  EXPECT_EQ(normal("ReverseOrientation"), (Vec3f{0, 0, -1}));
  EXPECT_EQ(normal("ReverseOrientation ReverseOrientation"), (Vec3f{0, 0, 1}));
  EXPECT_EQ(normal("Scale -1 1 1"), (Vec3f{0, 0, 1}));  // what was outside stays outside
  EXPECT_EQ(normal("Scale 1 1 -2"), (Vec3f{0, 0, -1}));
  EXPECT_EQ(normal("Scale -1 1 1 ReverseOrientation"), (Vec3f{0, 0, -1}));
  // Normals are no directions: a stretch tilts them the other way.
  const Scene scene = load_world(
      "Scale 2 1 1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 0 0 1 1 1 0] \"normal N\" [-1 1 0 -1 1 0 -1 1 0]");
  expect_near(to_double(normals(scene.meshes[0])[0]), normalize(Vec3d{-1, 2, 0}), 1e-6);
}

TEST_F(PbrtTransform, LeftHandedWorldsAreMirroredWhole) {
  const std::string world =
      "WorldBegin LightSource \"point\" \"point from\" [4 5 6] "
      "LightSource \"distant\" \"point to\" [1 0 0] "
      "LightSource \"spot\" \"point from\" [1 0 0] \"point to\" [3 0 0]\n" +
      std::string(kTriangle);
  for (const std::string camera : {"", "Camera \"perspective\" "}) {
    const Scene scene = load(camera + world);
    EXPECT_EQ(positions(scene.meshes[0])[0], (Vec3d{-1, 2, 3}));
    EXPECT_EQ(std::get<PointLight>(scene.lights.at(0)).position, (Vec3f{-4, 5, 6}));
    EXPECT_EQ(std::get<DirectionalLight>(scene.lights.at(1)).direction, (Vec3f{-1, 0, 0}));
    EXPECT_EQ(std::get<SpotLight>(scene.lights.at(2)).position, (Vec3f{-1, 0, 0}));
    EXPECT_EQ(std::get<SpotLight>(scene.lights.at(2)).direction, (Vec3f{-1, 0, 0}));
    EXPECT_GT(geometric_normal(scene.meshes[0]).z, 0) << "the mirror must not turn it round";
  }
}

}  // namespace
}  // namespace kairos
