// Tangents by MikkTSpace's rules.
#include "scene_io/tangents.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "seed.h"

namespace kairos {
namespace {

struct Patch {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  std::vector<Triangle> triangles;

  uint32_t add(Vec3f position, Vec2f uv, Vec3f normal = {0, 0, 1}) {
    positions.push_back(position);
    normals.push_back(normal);
    uvs.push_back(uv);
    return static_cast<uint32_t>(positions.size() - 1);
  }
  CornerTangents tangents() const { return make_tangents(positions, normals, uvs, triangles); }
};

Vec4f at(const CornerTangents& made, size_t triangle, size_t corner) {
  return made.tangents.at(made.corner.at(3 * triangle + corner));
}

void expect_near(const Vec4f& actual, const Vec4f& expected) {
  EXPECT_NEAR(actual.x, expected.x, 1e-6);
  EXPECT_NEAR(actual.y, expected.y, 1e-6);
  EXPECT_NEAR(actual.z, expected.z, 1e-6);
  EXPECT_EQ(actual.w, expected.w);
}

/// Two triangles in a plane that meet at the edge from (0, 0) to (0, 1), each with vertices of its own. On the right
/// one u rises along x, on the left one along `left`; neither is mirrored.
Patch hinge(Vec2d left) {
  Patch patch;
  const auto uv = [](double u, double v) { return Vec2f{static_cast<float>(u), static_cast<float>(v)}; };
  const uint32_t a = patch.add({0, 0, 0}, {0, 0}), b = patch.add({0, 1, 0}, {0, -1});
  patch.triangles.push_back({a, patch.add({1, 0, 0}, {1, 0}), b});
  // (u, -v) are coordinates along `left` and across it.
  const auto lies = [&](double x, double y) { return uv(x * left.x + y * left.y, x * left.y - y * left.x); };
  const uint32_t c = patch.add({0, 0, 0}, lies(0, 0)), d = patch.add({0, 1, 0}, lies(0, 1));
  patch.triangles.push_back({c, d, patch.add({-1, 0, 0}, lies(-1, 0))});
  return patch;
}

TEST(Tangents, FollowThePictureOnOneTriangle) {
  Patch patch = hinge({1, 0});
  const CornerTangents made = patch.tangents();
  ASSERT_EQ(made.corner.size(), 6u);
  for (size_t t = 0; t < 2; ++t)
    for (size_t i = 0; i < 3; ++i) expect_near(at(made, t, i), {1, 0, 0, 1});
  EXPECT_EQ(made.corner[0], made.corner[3]) << "vertices that are the same in all respects are one";
}

TEST(Tangents, VerticesThatDifferKeepTheirOwn) {
  const CornerTangents made = hinge({0, 1}).tangents();
  expect_near(at(made, 0, 0), {1, 0, 0, 1});
  expect_near(at(made, 1, 0), {0, 1, 0, 1});
}

// Around one vertex, two triangles of 90 and 45 degrees with tangents at right angles.
TEST(Tangents, AreMeansWeighedByAngle) {
  Patch patch;
  const uint32_t middle = patch.add({0, 0, 0}, {0, 0}), edge = patch.add({0, 1, 0}, {0, -1});
  patch.triangles.push_back({middle, patch.add({1, 0, 0}, {1, 0}), edge});
  // Its picture is sheared: u = x and -v = y - x, so that u rises, with v as it is, where y = x.
  patch.triangles.push_back({middle, edge, patch.add({-1, 1, 0}, {-1, -2})});
  const double s = std::sqrt(0.5), w1 = M_PI / 2, w2 = M_PI / 4;
  const double length = std::hypot(w1 + w2 * s, w2 * s);
  const CornerTangents made = patch.tangents();
  expect_near(at(made, 0, 0), {static_cast<float>((w1 + w2 * s) / length), static_cast<float>(w2 * s / length), 0, 1});
  EXPECT_EQ(made.corner[0], made.corner[3]);
  expect_near(at(made, 0, 1), {1, 0, 0, 1});
  expect_near(at(made, 1, 2), {static_cast<float>(s), static_cast<float>(s), 0, 1});
}

TEST(Tangents, MirroredPicturesDoNotMix) {
  Patch patch;
  const uint32_t a = patch.add({0, 0, 0}, {0, 0}), b = patch.add({0, 1, 0}, {0, -1});
  patch.triangles.push_back({a, patch.add({1, 0, 0}, {1, 0}), b});
  patch.triangles.push_back({a, b, patch.add({-1, 0, 0}, {1, 0})});
  const CornerTangents made = patch.tangents();
  expect_near(at(made, 0, 0), {1, 0, 0, 1});
  expect_near(at(made, 1, 0), {-1, 0, 0, -1});
  EXPECT_NE(made.corner[0], made.corner[3]);
}

TEST(Tangents, TrianglesOnlySharingAVertexDoNotMix) {
  Patch patch;
  const uint32_t a = patch.add({0, 0, 0}, {0, 0});
  patch.triangles.push_back({a, patch.add({1, 0, 0}, {1, 0}), patch.add({0, 1, 0}, {0, -1})});
  patch.triangles.push_back({a, patch.add({-1, 0, 0}, {0, -1}), patch.add({0, -1, 0}, {-1, 0})});
  const CornerTangents made = patch.tangents();
  expect_near(at(made, 0, 0), {1, 0, 0, 1});
  expect_near(at(made, 1, 0), {0, 1, 0, 1});
}

TEST(Tangents, WhatCoversNothingOfThePictureGoesWithItsNeighbours) {
  Patch patch;
  const uint32_t a = patch.add({0, 0, 0}, {0, 0}), b = patch.add({0, 1, 0}, {0, -1});
  patch.triangles.push_back({a, patch.add({1, 0, 0}, {1, 0}), b});
  const uint32_t c = patch.add({-1, 0, 0}, {0, 0});
  patch.triangles.push_back({a, b, c});  // two of its corners lie on one point of the picture
  patch.triangles.push_back({a, a, c});  // no triangle
  const CornerTangents made = patch.tangents();
  expect_near(at(made, 1, 0), {1, 0, 0, 1});
  expect_near(at(made, 2, 0), {1, 0, 0, 1});
  EXPECT_EQ(made.corner[5], kNoTangent) << "nobody beside it knows better";
}

/// A closed surface with smooth normals: the order of triangles, and which of its corners comes first, change nothing,
/// and tangents lie across normals.
TEST(Tangents, DoNotDependOnTheOrderOfTriangles) {
  std::mt19937 random(test::seed());
  Patch patch;
  constexpr int kSteps = 6;
  std::uniform_real_distribution<float> shake(-0.02f, 0.02f);
  for (int y = 0; y <= kSteps; ++y)
    for (int x = 0; x <= kSteps; ++x) {
      const double lon = 0.4 * x, lat = 0.3 * (y - 3);
      const Vec3f n = to_float({std::cos(lat) * std::sin(lon), std::sin(lat), std::cos(lat) * std::cos(lon)});
      patch.add(n, {static_cast<float>(x) / kSteps + shake(random), static_cast<float>(-y) / kSteps + shake(random)},
                n);
    }
  for (uint32_t y = 0; y < kSteps; ++y)
    for (uint32_t x = 0; x < kSteps; ++x) {
      const uint32_t a = y * (kSteps + 1) + x, b = a + kSteps + 1;
      patch.triangles.push_back({a, a + 1, b});
      patch.triangles.push_back({a + 1, b + 1, b});
    }
  const auto by_vertex = [](const Patch& some) {
    const CornerTangents made = some.tangents();
    std::vector<Vec4f> result(some.positions.size());
    for (size_t t = 0; t < some.triangles.size(); ++t)
      for (size_t i = 0; i < 3; ++i) result[some.triangles[t][i]] = at(made, t, i);
    return result;
  };
  const std::vector<Vec4f> first = by_vertex(patch);
  std::shuffle(patch.triangles.begin(), patch.triangles.end(), random);
  for (Triangle& t : patch.triangles) std::rotate(t.begin(), t.begin() + static_cast<long>(random() % 3), t.end());
  const std::vector<Vec4f> other = by_vertex(patch);
  for (size_t v = 0; v < first.size(); ++v) {
    expect_near(first[v], other[v]);
    const Vec3f tangent{first[v].x, first[v].y, first[v].z};
    EXPECT_NEAR(length(tangent), 1, 1e-5);
    EXPECT_NEAR(dot(tangent, patch.normals[v]), 0, 1e-5);
    EXPECT_GT(tangent.x * patch.normals[v].z - tangent.z * patch.normals[v].x, 0.5f) << "eastwards";
    EXPECT_EQ(first[v].w, 1);
  }
}

TEST(Tangents, SplitTheVerticesOfAGltfWithAllThatTheyHave) {
  GltfBuilder gltf;
  const int positions = gltf.accessor<float>({0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0}, "VEC3");
  const int indices = gltf.accessor<uint8_t>({0, 2, 1, 0, 1, 3}, "SCALAR");
  const int shifts = gltf.accessor<float>({0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4}, "VEC3");
  gltf.mesh_node({{"attributes",
                   {{"POSITION", positions},
                    {"NORMAL", gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                    {"TEXCOORD_0", gltf.accessor<float>({0, 0, 0, -1, 1, 0, 1, 0}, "VEC2")},
                    {"COLOR_0", gltf.accessor<float>({0, 0, 0, .25, 0, 0, .5, 0, 0, .75, 0, 0}, "VEC3")},
                    {"JOINTS_0", gltf.accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4")},
                    {"WEIGHTS_0", gltf.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4")}}},
                  {"indices", indices},
                  {"targets", {{{"POSITION", shifts}}}},
                  {"material", 0}},
                 {{"skin", 0}, {"weights", {1}}});
  gltf.push("nodes", {{"translation", {0, 0, 0}}});
  gltf.push("nodes", {{"translation", {0, 10, 0}}});
  gltf.root["skins"] = nlohmann::json::array({{{"joints", {1, 2}}}});
  gltf.root["images"] = nlohmann::json::array({{{"uri", "bumps.png"}}});
  gltf.root["textures"] = nlohmann::json::array({{{"source", 0}}});
  gltf.root["materials"] = nlohmann::json::array({{{"normalTexture", {{"index", 0}}}}});
  const Scene scene = GltfBuilder::parse_text(gltf.text(), {}, "/nowhere");
  EXPECT_TRUE(scene.warnings.empty());
  const SceneMesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.motion->vertex_count(), 6u) << "two of the four are split";
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 2, 1}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{4, 5, 3}));
  EXPECT_EQ(mesh.colors[4], mesh.colors[0]);
  EXPECT_EQ(mesh.colors[5].x, 0.25f);
  EXPECT_EQ(mesh.uvs[5], mesh.uvs[1]);
  const std::vector<Vec3d> now = positions_at(scene, 0);
  EXPECT_EQ(now[4], (Vec3d{0, 0, 1}));
  EXPECT_EQ(now[5], (Vec3d{0, 11, 2})) << "its joint and its displacement";
  std::vector<Vec4f> tangents(6);
  mesh.motion->tangents(0, Side::after, tangents);
  expect_near(tangents[0], {1, 0, 0, 1});
  expect_near(tangents[4], {-1, 0, 0, -1});
}

}  // namespace
}  // namespace kairos
