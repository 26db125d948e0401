#include "shading/smooth_joint.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kairos {
namespace {

constexpr JointNeeds kAll{true, true}, kNormals{true, false}, kUvs{false, true};

// Two triangles left and right of the edge x = 0, the right one turned by `angle` degrees about it, each with vertices
// of its own. Static.
Mesh hinge(double angle) {
  const double a = angle * M_PI / 180;
  const Vec3f tip{static_cast<float>(std::cos(a)), 0, static_cast<float>(std::sin(a))};
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.positions = {{{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 0}, tip}};
  return mesh;
}

Mesh with_common_vertices(double angle) {
  Mesh mesh = hinge(angle);
  mesh.triangles[1] = {1, 0, 5};
  return mesh;
}

std::vector<Vec3f> normals(Vec3f left, Vec3f right) { return {left, left, left, right, right, right}; }

TEST(SmoothJoint, WithoutNormalsTheFacesDecide) {
  for (const auto make : {hinge, with_common_vertices}) {
    EXPECT_TRUE(smooth_joint(make(0), 0, 1, 0, kAll));
    EXPECT_TRUE(smooth_joint(make(29), 0, 1, 0, kAll));
    EXPECT_TRUE(smooth_joint(make(-29), 1, 0, 0, kAll));
    EXPECT_FALSE(smooth_joint(make(31), 0, 1, 0, kAll));
    EXPECT_FALSE(smooth_joint(make(-31), 0, 1, 0, kAll));
    EXPECT_FALSE(smooth_joint(make(180), 0, 1, 0, kAll));
    EXPECT_TRUE(smooth_joint(make(90), 0, 1, 0, kUvs)) << "a colour that does not depend on normals";
  }
}

TEST(SmoothJoint, OneCornerIsEnough) {
  Mesh mesh = hinge(0);
  mesh.positions[0][3] = {0, 3, 0};
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0, kAll));
  mesh.positions[0][4] = {0, 1e-6f, 0};
  EXPECT_FALSE(smooth_joint(mesh, 0, 1, 0, kAll)) << "none in common";
}

// The mesh's own normals are what is shaded with, whatever the faces do.
TEST(SmoothJoint, OwnNormalsDecideWhereThereAreAny) {
  Mesh folded = hinge(90);
  folded.normals = {normals({0, 0, 1}, {0, 0, 1})};
  EXPECT_TRUE(smooth_joint(folded, 0, 1, 0, kNormals));
  Mesh flat = hinge(0);
  flat.normals = {normals({0, 0, 1}, {1, 0, 0})};
  EXPECT_FALSE(smooth_joint(flat, 0, 1, 0, kNormals)) << "a hard edge";
  Mesh common = with_common_vertices(90);
  common.normals = {normals({0, 0, 1}, {1, 0, 0})};
  EXPECT_TRUE(smooth_joint(common, 0, 1, 0, kNormals)) << "one vertex has one normal";
}

TEST(SmoothJoint, PicturesMustGoOnToo) {
  Mesh mesh = hinge(0);
  mesh.uvs = {{0, 0}, {0, 1}, {1, 0}, {0, 1}, {0, 0}, {1, 1}};
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0, kAll));
  mesh.uvs[3] = mesh.uvs[4] = {0.5f, 0.5f};
  EXPECT_FALSE(smooth_joint(mesh, 0, 1, 0, kAll)) << "a seam";
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0, kNormals)) << "without a picture";
}

TEST(SmoothJoint, SoMustFurtherCoordinatesAndColours) {
  Mesh mesh = hinge(0);
  mesh.more_uvs = {{}, {{0, 0}, {0, 1}, {1, 0}, {0, 1}, {0, 0}, {1, 1}}};
  mesh.colors.assign(6, {1, 0.5f, 0, 1});
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0, kAll));
  Mesh seam = mesh, painted = mesh;
  seam.more_uvs[1][3] = seam.more_uvs[1][4] = {0.5f, 0.5f};
  EXPECT_FALSE(smooth_joint(seam, 0, 1, 0, kAll));
  for (const size_t v : {3, 4}) painted.colors[v].w = 0.5f;
  EXPECT_FALSE(smooth_joint(painted, 0, 1, 0, kAll));
}

// Looked at near the time of the change: the hinge is straight first and folded later.
TEST(SmoothJoint, AtTheTimeOfTheChange) {
  Mesh mesh = hinge(0);
  mesh.key_times = {0, 0.5f, 1};
  mesh.positions.push_back(hinge(60).positions[0]);
  mesh.positions.push_back(hinge(60).positions[0]);
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0.1f, kAll));
  EXPECT_FALSE(smooth_joint(mesh, 0, 1, 0.6f, kAll));
  mesh.normals = {normals({0, 0, 1}, {0, 0, 1}), normals({0, 0, 1}, {1, 0, 0}), normals({0, 0, 1}, {1, 0, 0})};
  EXPECT_TRUE(smooth_joint(mesh, 0, 1, 0.1f, kAll));
  EXPECT_FALSE(smooth_joint(mesh, 0, 1, 0.6f, kAll));
}

}  // namespace
}  // namespace kairos
