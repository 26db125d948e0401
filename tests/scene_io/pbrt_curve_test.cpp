// Curves as ribbons and tubes.
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "pbrt_fixture.h"
#include "seed.h"

namespace kairos {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class PbrtCurve : public PbrtTest {
 protected:
  /// Seen from (0, 0, 10), with 100 pixels to a unit.
  Scene seen(const std::string& statements, bool strict = false) const {
    return load(
        "Scale -1 1 1 LookAt 0 0 10 0 0 0 0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-1 1 -1 1]\n"
        "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 200\nWorldBegin\n" +
            statements,
        strict);
  }
  /// Middles between the two edges of a ribbon, in order.
  static std::vector<Vec3d> middles(const SceneMesh& mesh, double time = 0) {
    const std::vector<Vec3d> p = positions(mesh, time);
    std::vector<Vec3d> line;
    for (size_t i = 0; i + 1 < p.size(); i += 2) line.push_back((p[i] + p[i + 1]) * 0.5);
    return line;
  }
};

TEST_F(PbrtCurve, AFlatOneFacesTheEye) {
  const Scene scene =
      seen("Shape \"curve\" \"point3 P\" [-2 0 0  -.7 .2 1  .7 -.2 -1  2 0 0] \"float width\" .4", true);
  const SceneMesh& mesh = scene.meshes.at(0);
  const std::vector<Vec3d> p = positions(mesh);
  const std::vector<Vec3f> n = normals(mesh);
  for (size_t i = 0; i + 1 < p.size(); i += 2) {
    EXPECT_NEAR(length(p[i + 1] - p[i]), 0.4, 1e-6);
    EXPECT_NEAR(p[i].z, p[i + 1].z, 1e-6) << "across the view";
    EXPECT_GT(n[i].z, 0);
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_GT(geometric_normal(mesh, t).z, 0);
  expect_near(middles(mesh).front(), {-2, 0, 0}, 1e-6);
  expect_near(middles(mesh).back(), {2, 0, 0}, 1e-6);
}

/// Every basis and degree against its definition: recursion of de Boor for splines, of de Casteljau for Bézier curves.
TEST_F(PbrtCurve, BasesAndDegrees) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int degree : {2, 3})
    for (const bool spline : {false, true}) {
      const int segments = 3, count = spline ? degree + segments : degree * segments + 1;
      std::vector<Vec3d> control;
      std::string text = "Shape \"curve\" \"string basis\" \"" + std::string(spline ? "bspline" : "bezier") +
                         "\" \"integer degree\" " + std::to_string(degree) + " \"float width\" .001 \"point3 P\" [";
      for (int i = 0; i < count; ++i) {
        control.push_back(to_double(to_float({uniform(random), uniform(random), 0})));
        text += fmt::format("{} {} 0 ", control.back().x, control.back().y);
      }
      const auto exact = [&](double s) {  // s: 0 to the number of segments
        const int segment = std::min(static_cast<int>(s), segments - 1);
        std::vector<Vec3d> d;
        for (int i = 0; i <= degree; ++i)
          d.push_back(control[static_cast<size_t>(spline ? segment + i : segment * degree + i)]);
        for (int r = 1; r <= degree; ++r)
          for (int i = degree; i >= r; --i) {
            const double local = s - segment;
            const double weight = spline ? (local + degree - i) / (degree + 1 - r) : local;
            d[static_cast<size_t>(i)] = lerp(d[static_cast<size_t>(i) - 1], d[static_cast<size_t>(i)], weight);
          }
        return d[static_cast<size_t>(degree)];
      };
      const std::vector<Vec3d> line = middles(seen(text + "]", true).meshes.at(0));
      double farthest = 0;
      for (const Vec3d& p : line) {  // each lies on the curve
        double nearest = 9;
        for (int i = 0; i <= 3000; ++i) nearest = std::min(nearest, length(exact(i / 1000.0) - p));
        farthest = std::max(farthest, nearest);
      }
      EXPECT_LT(farthest, 0.005);
      expect_near(line.front(), exact(0), 1e-6);
      expect_near(line.back(), exact(segments), 1e-6);
      // And the lines between them leave it by a tenth of a pixel at most: a unit is 100 pixels.
      for (int i = 0; i <= 600; ++i) {
        const Vec3d p = exact(i / 200.0);
        double nearest = 9;
        for (size_t k = 0; k + 1 < line.size(); ++k) {
          const Vec3d way = line[k + 1] - line[k];
          const double along = std::clamp(dot(p - line[k], way) / std::max(dot(way, way), 1e-30), 0.0, 1.0);
          nearest = std::min(nearest, length(p - line[k] - way * along));
        }
        EXPECT_LT(nearest, 0.00101);
      }
    }
}

TEST_F(PbrtCurve, ATubeIsRoundAndAsWideAsItSays) {
  const Scene scene = seen(
      "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [0 -1 0  0 -.3 0  0 .3 0  0 1 0] "
      "\"float width0\" .5 \"float width1\" .25");
  const SceneMesh& mesh = scene.meshes.at(0);
  // A cone's stump: pi (r0 + r1) times the slant's length. Its prism is as wide in the mean as the cone.
  EXPECT_NEAR(area(mesh), pi * 0.375 * std::hypot(2, 0.125), 0.02);
  for (const Vec3f& n : normals(mesh)) EXPECT_NEAR(n.y, 0, 1e-6);
  const std::vector<Vec3d> points = positions(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d p = points[mesh.triangles[t][0]];
    EXPECT_GT(dot(geometric_normal(mesh, t), Vec3d{p.x, 0, p.z}), 0) << "faces outwards";
  }
}

TEST_F(PbrtCurve, ARibbonHasNormalsOfItsOwn) {
  const Scene scene = seen(
      "Shape \"curve\" \"string type\" \"ribbon\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] "
      "\"normal N\" [0 0 1  0 1 0] \"float width\" 2");
  const std::vector<Vec3f> n = normals(scene.meshes.at(0));
  expect_near(to_double(n.front()), {0, 0, 1}, 1e-6);
  expect_near(to_double(n.back()), {0, 1, 0}, 1e-6);
  const std::vector<Vec3d> p = positions(scene.meshes[0]);
  expect_near(p[1] - p[0], {0, -2, 0}, 1e-6);
}

TEST_F(PbrtCurve, StrandsBecomeOneMesh) {
  std::string hair;
  for (int i = 0; i < 500; ++i)
    hair += fmt::format("Shape \"curve\" \"point3 P\" [{0} 0 0  {0} .3 0  {0} .6 .1  {0} 1 0] \"float width\" .01\n",
                        0.001 * i);
  const Scene scene = seen(hair + "Translate 1 0 0\n" + hair + "ReverseOrientation\nMaterial \"mirror\"\n" + hair);
  ASSERT_THAT(scene.meshes, SizeIs(3));
  EXPECT_EQ(scene.meshes[0].triangles.size() % 500, 0u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), scene.meshes[1].triangles.size());
  EXPECT_EQ(scene.materials.at(scene.meshes[2].material).metallic, 1);
  EXPECT_THAT(scene.warnings, IsEmpty());
  // Moved as other shapes are, and round inside of objects, whose place is not known yet.
  const std::string one = "Shape \"curve\" \"point3 P\" [0 0 0 0 1 0 0 2 0 0 3 0]\n";
  const Scene moving = seen("ActiveTransform EndTime Translate 0 0 -5 ActiveTransform All\n" + one);
  expect_near(middles(moving.meshes.at(0), 1).front(), {0, 0, -5}, 1e-6);
  const Scene object = seen("ObjectBegin \"o\"\n" + one + one + "ObjectEnd\n" + one + "ObjectInstance \"o\"");
  ASSERT_THAT(object.meshes, SizeIs(2));
  EXPECT_GT(object.meshes[1].triangles.size(), 2 * object.meshes[0].triangles.size());
}

TEST_F(PbrtCurve, NonsenseIsRefused) {
  const auto refuse_curve = [&](const std::string& parameters, const std::string& word) {
    refuse("\nShape \"curve\" " + parameters, {"scene.pbrt:2", word});
  };
  refuse_curve("", "0 points make no curve");
  refuse_curve("\"point P\" [0 0 0 1 0 0 2 0 0 3 0 0 4 0 0]", "5 points make no curve of degree 3");
  refuse_curve("\"integer degree\" 4 \"point P\" [0 0 0 1 0 0 2 0 0 3 0 0]", "degree 4");
  refuse_curve("\"string basis\" \"b\" \"point P\" [0 0 0 1 0 0 2 0 0 3 0 0]", "basis 'b'");
  refuse_curve("\"string type\" \"t\" \"point P\" [0 0 0 1 0 0 2 0 0 3 0 0]", "type 't'");
  refuse_curve("\"string type\" \"ribbon\" \"point P\" [0 0 0 1 0 0 2 0 0 3 0 0]", "needs 2 normals");
  refuse_curve("\"float width\" -1 \"point P\" [0 0 0 1 0 0 2 0 0 3 0 0]", "negative");
  refuse_curve("\"point P\" [0 0 0 1 0 0 2 0 0 3 nan 0]", "not finite");
  // One that is a point has no triangles; control points that meet do no harm.
  EXPECT_THAT(seen("Shape \"curve\" \"point P\" [1 1 1 1 1 1 1 1 1 1 1 1]").meshes.at(0).triangles, IsEmpty());
  const Scene meets = seen("Shape \"curve\" \"point P\" [0 0 0 0 0 0 1 0 0 1 0 0]");
  for (const Vec3d& p : positions(meets.meshes.at(0))) EXPECT_TRUE(is_finite(to_float(p)));
}

}  // namespace
}  // namespace kairos
