// Shapes as triangles.
#include <cmath>
#include <numbers>

#include "gzip_text.h"
#include "pbrt_fixture.h"
#include "scene_io/pbrt/gzip.h"

namespace kairos {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\n"
    "property float v\nelement face 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";

class PbrtShapes : public PbrtTest {
 protected:
  SceneMesh shape(const std::string& statement) const { return load_world("Shape " + statement).meshes.at(0); }

  /// Triangles and normals agree on the side that `outside` says, for every triangle.
  template <class Outside>
  static void expect_front(const SceneMesh& mesh, const Outside& outside) {
    const std::vector<Vec3d> p = positions(mesh);
    const std::vector<Vec3f> n = normals(mesh);
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle& t = mesh.triangles[i];
      const Vec3d middle = (p[t[0]] + p[t[1]] + p[t[2]]) / 3.0;
      ASSERT_GT(dot(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]), outside(middle)), 0) << i;
      for (const uint32_t v : t) ASSERT_GE(dot(to_double(n[v]), outside(p[v])), 0.99 * length(outside(p[v]))) << i;
    }
  }
};

TEST_F(PbrtShapes, Sphere) {
  const SceneMesh mesh = shape("\"sphere\" \"float radius\" 2");
  EXPECT_NEAR(area(mesh), 16 * pi, 16 * pi * 1e-3);
  EXPECT_LT(area(mesh), 16 * pi);
  for (const Vec3d& p : positions(mesh)) EXPECT_NEAR(length(p), 2, 1e-6);
  expect_front(mesh, [](Vec3d p) { return p; });
  const std::vector<Vec3d> points = positions(mesh);
  for (size_t v = 0; v < points.size(); ++v)  // even in the angle from the pole, which ours counts from the top
    EXPECT_NEAR(points[v].z, 2 * std::cos(mesh.uvs[v].y * pi), 1e-6);
  // A band of a sphere has the area of the cylinder around it (Archimedes).
  const SceneMesh band = shape("\"sphere\" \"float radius\" 2 \"float zmin\" -1 \"float zmax\" .5 \"float phimax\" 90");
  EXPECT_NEAR(area(band), 2 * pi * 2 * 1.5 / 4, 0.005);
  for (const Vec3d& p : positions(band)) {
    EXPECT_GE(p.x, -1e-6);
    EXPECT_GE(p.y, -1e-6);
    EXPECT_GE(p.z, -1.000001);
    EXPECT_LE(p.z, 0.500001);
  }
}

TEST_F(PbrtShapes, Disk) {
  const SceneMesh mesh = shape("\"disk\" \"float radius\" 3 \"float innerradius\" 1 \"float height\" 5");
  EXPECT_NEAR(area(mesh), 8 * pi, 8 * pi * 1e-3);
  for (const Vec3d& p : positions(mesh)) EXPECT_EQ(p.z, 5);
  expect_front(mesh, [](Vec3d) { return Vec3d{0, 0, 1}; });
  EXPECT_NEAR(area(shape("\"disk\" \"float phimax\" 60")), pi / 6, 1e-3);
}

TEST_F(PbrtShapes, Cylinder) {
  const SceneMesh mesh = shape("\"cylinder\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" 4");
  EXPECT_NEAR(area(mesh), 2 * pi * 2 * 3, 2 * pi * 2 * 3 * 1e-3);
  expect_front(mesh, [](Vec3d p) { return Vec3d{p.x, p.y, 0}; });
}

TEST_F(PbrtShapes, Cone) {
  const SceneMesh mesh = shape("\"cone\" \"float radius\" 3 \"float height\" 4");
  EXPECT_NEAR(area(mesh), pi * 3 * 5, pi * 3 * 5 * 1e-3);
  expect_front(mesh, [](Vec3d p) { return Vec3d{4 * p.x, 4 * p.y, 3 * std::hypot(p.x, p.y)}; });
  for (const Vec3d& p : positions(mesh)) EXPECT_NEAR(std::hypot(p.x, p.y), 3 * (1 - p.z / 4), 1e-6);
}

TEST_F(PbrtShapes, Paraboloid) {
  // z = x^2 + y^2 from 1 to 4: its area is pi/6 ((4 z + 1)^(3/2)) between both.
  const SceneMesh mesh = shape("\"paraboloid\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" 4");
  const double exact = pi / 6 * (std::pow(17, 1.5) - std::pow(5, 1.5));
  EXPECT_NEAR(area(mesh), exact, exact * 1e-3);
  for (const Vec3d& p : positions(mesh)) EXPECT_NEAR(p.x * p.x + p.y * p.y, p.z, 1e-5);
  expect_front(mesh, [](Vec3d p) { return Vec3d{2 * p.x, 2 * p.y, -1}; });
}

TEST_F(PbrtShapes, Hyperboloid) {
  // A line beside the axis sweeps x^2 + y^2 - z^2 = 1.
  const SceneMesh mesh = shape("\"hyperboloid\" \"point p1\" [1 -2 -2] \"point p2\" [1 1 1] \"float phimax\" 180");
  for (const Vec3d& p : positions(mesh)) EXPECT_NEAR(p.x * p.x + p.y * p.y - p.z * p.z, 1, 1e-5);
  expect_front(mesh, [](Vec3d p) { return Vec3d{p.x, p.y, -p.z}; });
  // 2 pi times the integral of r sqrt(1 + r'^2): sqrt(1 + 2 z^2), for half a turn.
  const auto integral = [](double z) {
    return z / 2 * std::sqrt(1 + 2 * z * z) + std::asinh(std::sqrt(2) * z) / (2 * std::sqrt(2));
  };
  const double exact = pi * (integral(1) - integral(-2));
  EXPECT_NEAR(area(mesh), exact, exact * 2e-3);
}

TEST_F(PbrtShapes, QuadricsAreAsFineAsTheyAreLarge) {
  const auto triangles = [&](const std::string& statements, const std::string& camera = "\"perspective\"") {
    return load("LookAt 0 0 0 0 0 1 0 1 0\nCamera " + camera +
                "\nFilm \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 200\nWorldBegin\n" + statements)
        .meshes.at(0)
        .triangles.size();
  };
  const std::string ball = "Shape \"sphere\"";
  const size_t at_10 = triangles("Translate 0 0 11 " + ball);
  // Half as far, it is twice as wide, and needs root 2 as many steps both ways.
  EXPECT_GT(triangles("Translate 0 0 6 " + ball), 1.4 * static_cast<double>(at_10));
  EXPECT_LT(triangles("Translate 0 0 6 " + ball), 3 * static_cast<double>(at_10));
  EXPECT_EQ(triangles("Scale 5 5 5 Translate 0 0 11 " + ball), at_10) << "scaled as a whole it is as large";
  EXPECT_EQ(triangles("Translate 0 0 -11 " + ball), at_10) << "mirrors may show what is behind";
  EXPECT_LT(triangles("Translate 0 0 1000 " + ball), 200u);
  EXPECT_GT(triangles(ball), 30000u) << "the eye is inside";
  EXPECT_EQ(triangles("Translate 0 0 5 " + ball, "\"orthographic\""),
            triangles("Translate 0 0 50 " + ball, "\"orthographic\""));
  // Where it comes near while the shutter is open, that counts.
  EXPECT_GT(
      triangles("ActiveTransform EndTime Translate 0 0 6 ActiveTransform StartTime Translate 0 0 11 ActiveTransform "
                "All " +
                ball),
      at_10);
  // Instances are judged where they stand.
  EXPECT_EQ(triangles("ObjectBegin \"o\" " + ball + " ObjectEnd Translate 0 0 11 ObjectInstance \"o\""), at_10);
  // The outline leaves the circle by a tenth of a pixel at most: here a unit covers 10 pixels.
  const Scene scene = load(
      "LookAt 0 0 0 0 0 1 0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-10 10 -10 10]\nFilm \"rgb\" "
      "\"integer "
      "xresolution\" 200 \"integer yresolution\" 200\nWorldBegin\nTranslate 0 0 20\nShape \"disk\" \"float radius\" 7");
  const SceneMesh& disk = scene.meshes.at(0);
  const std::vector<Vec3d> p = positions(disk);
  double nearest = 7;
  for (const Triangle& t : disk.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d middle = (p[t[i]] + p[t[(i + 1) % 3]]) * 0.5 - Vec3d{0, 0, 20};
      if (length(p[t[i]] - Vec3d{0, 0, 20}) > 6.9 && length(p[t[(i + 1) % 3]] - Vec3d{0, 0, 20}) > 6.9)
        nearest = std::min(nearest, length(middle));
    }
  EXPECT_LT(7 - nearest, 0.0101);
  EXPECT_GT(7 - nearest, 0.003);
}

TEST_F(PbrtShapes, EqualQuadricsShareTheirVertices) {
  std::string text = "LookAt 0 0 0 0 0 1 0 1 0\nCamera \"orthographic\"\nWorldBegin\n";
  for (int i = 0; i < 50; ++i) text += "Translate 0 .01 0 Shape \"sphere\" \"float radius\" .02\n";
  const Scene scene = load(text);
  ASSERT_THAT(scene.meshes, SizeIs(50));
  size_t triangles = 0;
  for (const SceneMesh& mesh : scene.meshes) triangles += mesh.triangles.size();
  EXPECT_LT(triangles, 50u * 1000);
}

TEST_F(PbrtShapes, BilinearPatch) {
  const SceneMesh flat = shape("\"bilinearmesh\" \"point3 P\" [0 0 0  2 0 0  0 3 0  2 3 0]");
  EXPECT_EQ(flat.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(area(flat), 6);
  expect_front(flat, [](Vec3d) { return Vec3d{0, 0, 1}; });
  // z = x y over the unit square.
  const SceneMesh saddle =
      shape("\"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0  1 1 1] \"integer indices\" [0 1 2 3]");
  for (const Vec3d& p : positions(saddle)) EXPECT_NEAR(p.z, p.x * p.y, 1e-6);
  const std::vector<Vec3d> p = positions(saddle);
  const std::vector<Vec3f> n = normals(saddle);
  for (size_t v = 0; v < p.size(); ++v) expect_near(to_double(n[v]), normalize(Vec3d{-p[v].y, -p[v].x, 1}), 1e-6);
}

TEST_F(PbrtShapes, TriangleMesh) {
  const SceneMesh mesh = shape(
      "\"trianglemesh\" \"integer indices\" [0 1 2 2 1 3] \"point P\" [0 0 0 1 0 0 0 1 0 1 1 0] "
      "\"float uv\" [0 0 1 0 0 .25 1 1]");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}));
  // pbrt counts from an image's lower edge, Kairos from the upper.
  EXPECT_THAT(mesh.uvs, ElementsAre(Vec2f{0, 1}, Vec2f{1, 1}, Vec2f{0, 0.75f}, Vec2f{1, 0}));
  EXPECT_FALSE(mesh.motion->has_normals());
}

TEST_F(PbrtShapes, BadTrianglesAreDropped) {
  const std::string text =
      "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 1 9 0 1 3 0 1 -1] \"point P\" [0 0 0 1 0 0 0 1 0 nan 1e99 "
      "0]";
  const Scene scene = load_world(text);
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("3 of 4 triangles dropped: 2 with a vertex index out of range, 1 with")));
  expect_error([&] { load_world(text, true); }, {"scene.pbrt:4", "3 of 4 triangles"});
}

TEST_F(PbrtShapes, PlyMeshesPlainAndPacked) {
  folder_.write("models/a.ply", kPly);
  folder_.write("models/b.ply.gz", test::gzipped(kPly));
  folder_.write("c.pbrt.gz", test::gzipped("Shape \"plymesh\" \"string filename\" \"models/a.ply\""));
  const Scene scene = load_world(
      "Shape \"plymesh\" \"string filename\" \"models/a.ply\"\n"
      "Shape \"plymesh\" \"string filename\" [ \"models/b.ply.gz\" ]\nInclude \"c.pbrt.gz\"");
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(scene.meshes[0].name, "a");
  EXPECT_EQ(scene.meshes[1].name, "b");
  for (const SceneMesh& mesh : scene.meshes) {
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_DOUBLE_EQ(area(mesh), 1);
    EXPECT_EQ(mesh.uvs.at(2), (Vec2f{1, 0}));
  }
}

TEST_F(PbrtShapes, PackedFilesAreNotTrusted) {
  const std::string text(100000, 'x'), good = test::gzipped(text);
  const auto unpack = [](const std::string& bytes, uint64_t limit) { return pbrt::gunzip(bytes, limit, "p").size(); };
  EXPECT_EQ(unpack(good, 100000), 100000u);
  EXPECT_EQ(unpack(good + good, 1 << 20), 200000u);  // gzip files may be put one after the other
  expect_error([&] { unpack(good, 99999); }, {"p: unpacks to more than 99999 bytes"});
  expect_error([&] { unpack(good.substr(0, good.size() - 9), 1 << 20); }, {"cut short"});
  expect_error([&] { unpack("", 1 << 20); }, {"cut short"});
  std::string changed = good;
  changed[changed.size() - 6] ^= 1;  // of the checksum
  expect_error([&] { unpack(changed, 1 << 20); }, {"no whole gzip file"});
  expect_error([&] { unpack("ply\nformat ascii 1.0\n", 1 << 20); }, {"no whole gzip file"});
}

TEST_F(PbrtShapes, UnknownShapesAreReportedOnce) {
  const Scene scene =
      load_world("Shape \"nurbs\" \"point P\" [0 0 0]\nShape \"nurbs\"\nShape \"sphere\" \"float x\" 1");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("scene.pbrt:4: shapes of kind 'nurbs' are left out (2 times)"),
                                          HasSubstr("scene.pbrt:6: parameter 'x' of shape 'sphere' is left out")));
  EXPECT_EQ(scene.meshes.size(), 1u);
}

TEST_F(PbrtShapes, NonsenseIsRefused) {
  refuse("\n\nShape \"sphere\" \"float radius\" 0", {"scene.pbrt:3", "radius"});
  refuse("Shape \"sphere\" \"float radius\" nan", {"radius"});
  refuse("Shape \"sphere\" \"float zmin\" 2", {"zmin"});
  refuse("Shape \"sphere\" \"float phimax\" 0", {"phimax"});
  refuse("Shape \"disk\" \"float innerradius\" 1", {"innerradius"});
  refuse("Shape \"cylinder\" \"float zmin\" 1", {"zmin"});
  refuse("Shape \"trianglemesh\"", {"points 'P'"});
  refuse("Shape \"trianglemesh\" \"point P\" [0 0]", {"'P' has 2 values"});
  refuse("Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]", {"three for each"});
  refuse("Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]", {"one normal for each"});
  refuse("Shape \"bilinearmesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2 3]", {"out of range"});
  refuse("Shape \"plymesh\"", {"filename"});
  refuse("Shape \"plymesh\" \"string filename\" \"../x.ply\"", {"scene.pbrt:1", "x.ply"});
}

/// Two kinds of spheres, each of fewer triangles than are worth sharing, are more together.
TEST_F(PbrtShapes, EqualSpheresAreKeptOnceWhereThereAreMany) {
  const auto notes = [&](int copies) {
    std::string text = "WorldBegin\n";  // without a camera each sphere has 16128 triangles
    for (int i = 0; i < copies; ++i)
      for (const char* radius : {"1", "2"})
        text += "AttributeBegin Translate " + std::to_string(5 * i) + " 0 0 Shape \"sphere\" \"float radius\" " +
                radius + " AttributeEnd\n";
    return make_shot(load(text)).notes;
  };
  EXPECT_THAT(notes(40), testing::Contains(testing::HasSubstr("80 meshes are instances of 2 objects")));
  EXPECT_THAT(notes(2), testing::Not(testing::Contains(testing::HasSubstr("instances"))));
}

}  // namespace
}  // namespace kairos
