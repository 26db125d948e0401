#include "scene_io/obj/obj.h"

#include <clocale>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

MeshData load(const std::vector<std::string>& texts, bool strict = false) {
  std::vector<PolygonMesh> keys;
  for (size_t k = 0; k < texts.size(); ++k) keys.push_back(parse_obj(texts[k], "key" + std::to_string(k) + ".obj"));
  return make_mesh_data(std::move(keys), strict);
}
MeshData load(const std::string& text) { return load(std::vector<std::string>{text}); }

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, TrianglesKeepTheFilesOrder) {
  const MeshData mesh = load("v 1 2.5 -3e2\nv +4 .5 6.\nv 7 8 9\nv 1 1 1\nf 3 2 1\nf 1 2 4\n");
  EXPECT_THAT(mesh.positions,
              ElementsAre(ElementsAre(Vec3f{1, 2.5, -300}, Vec3f{4, 0.5, 6}, Vec3f{7, 8, 9}, Vec3f{1, 1, 1})));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{2, 1, 0}, Triangle{0, 1, 3}));
  EXPECT_THAT(mesh.prim_ids, IsEmpty());
  EXPECT_THAT(mesh.normals, IsEmpty());
  EXPECT_THAT(mesh.uvs, IsEmpty());
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST(Obj, PolygonsCountAsTheirTriangles) {
  const MeshData mesh = load(kSquare + "f 1 2 3\nf 1 2 3 4\nf 4 3 2\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{3, 2, 1}));
}

TEST(Obj, NegativeIndicesCountBackFromTheirLine) {
  const MeshData mesh = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -1 -2\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 3, 2}));
}

TEST(Obj, PositiveIndicesMayComeBeforeTheirVertices) {
  EXPECT_THAT(load("f 1 2 3\n" + kSquare).triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST(Obj, ContinuedLinesCommentsAndAnyLineEnd) {
  const std::string text =
      "# c\\\nstill a comment\nv 0 0 0 # zero\nv 1 \\\n 0 0\n\tv 0 1 0\no a\ng b c\nusemtl x\ns 1\nf 1 \\\n2 \\\n3";
  const MeshData unix_lines = load(text);
  EXPECT_THAT(unix_lines.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(unix_lines.positions[0][1], (Vec3f{1, 0, 0}));
  for (const std::string end : {"\r\n", "\r"}) {
    std::string other;
    for (const char c : text) c == '\n' ? other += end : other += c;
    const MeshData mesh = load(other);
    EXPECT_EQ(mesh.triangles, unix_lines.triangles);
    EXPECT_EQ(mesh.positions, unix_lines.positions);
  }
}

TEST(Obj, CornersThatDifferSplitTheirVertex) {
  const MeshData mesh = load(kSquare +
                             "vt 0 0\nvt 1 0.5\nvt 0.25\nvn 0 0 2\nvn 0 -1 0\n"
                             "f 1/1/1 2/2/1 3/3/1\nf 1/1/2 3/3/1 4/1/1\nf 1/1/2 2/2/1 4/2/1\n");
  // Vertex 1 also appears with the second normal, vertex 4 with a second texture coordinate: in that order of passes.
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{5, 2, 3}, Triangle{5, 1, 4}));
  EXPECT_THAT(mesh.positions, ElementsAre(ElementsAre(Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{1, 1, 0}, Vec3f{0, 1, 0},
                                                      Vec3f{0, 1, 0}, Vec3f{0, 0, 0})));
  const Vec3f up{0, 0, 1}, down{0, -1, 0};
  EXPECT_THAT(mesh.normals, ElementsAre(ElementsAre(up, up, up, up, up, down)));
  EXPECT_THAT(mesh.uvs,
              ElementsAre(Vec2f{0, 0}, Vec2f{1, 0.5}, Vec2f{0.25, 0}, Vec2f{0, 0}, Vec2f{1, 0.5}, Vec2f{0, 0}));
}

TEST(Obj, CornerForms) {
  const MeshData normals = load(kSquare + "vn 0 0 1\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(normals.normals.at(0).at(2), (Vec3f{0, 0, 1}));
  EXPECT_THAT(normals.uvs, IsEmpty());
  const MeshData uvs = load(kSquare + "vt 3 4\nf 1/1 2/-1 3/1\n");
  EXPECT_EQ(uvs.uvs.at(1), (Vec2f{3, 4}));
  EXPECT_THAT(uvs.normals, IsEmpty());
  for (const char* bad : {"f 1/2/3/4 2 3", "f a 2 3", "f 1.5 2 3", "f /1 2 3", "f 99999999999999999999 2 3"})
    expect_error([&] { load(kSquare + bad); }, {"key0.obj:5", "is not an index"});
}

TEST(Obj, NormalsAreLeftOutWhereSomeCornerHasNone) {
  const MeshData mesh = load(kSquare + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n");
  EXPECT_THAT(mesh.normals, IsEmpty());
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_THAT(mesh.warnings[0], HasSubstr("normals left out"));
}

TEST(Obj, BadTrianglesAreDroppedCountedAndReportedOnce) {
  const std::string text =
      kSquare + "v nan 0 0\nv 0 1e39 0\nf 1 2 3\nf 1 2 0\nf 1 2 5\nf 1 2 9 4\nf 6 2 3\nf 2 3 4\nf -9 1 2\nf 1 2\n";
  const MeshData mesh = load(text);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 2, 3}));
  EXPECT_THAT(mesh.prim_ids, ElementsAre(0, 6));
  EXPECT_THAT(mesh.warnings,
              ElementsAre("key0.obj: 1 faces with fewer than 3 corners left out",
                          "key0.obj: 6 of 8 triangles dropped: 4 with a vertex index out of range, 2 with a "
                          "vertex that is not finite"));
  expect_error([&] { load({text}, true); }, {"key0.obj: 1 faces with fewer than 3 corners"});
}

TEST(Obj, CornersWhoseAttributesAreNotThereKeepTheirPlace) {
  const MeshData none = load(kSquare + "g all\nf 1/5/1 2/6/2 3/7/3\n");
  EXPECT_THAT(none.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(none.normals, IsEmpty());
  EXPECT_THAT(none.uvs, IsEmpty());
  EXPECT_THAT(
      none.warnings,
      ElementsAre("key0.obj: 3 of 3 face corners name normals that are not there (the file has 0): they have none",
                  "key0.obj: 3 of 3 face corners name texture coordinates that are not there (the file has 0): they "
                  "have none"));
  // One that is missing takes nothing from the others.
  const MeshData one = load(kSquare + "vt .5 .25\nf 1/1 2/1 3/2\nf 1/1 3/1 4/-9\n");
  EXPECT_THAT(one.triangles, SizeIs(2));
  EXPECT_THAT(one.uvs, ElementsAre(Vec2f{0.5, 0.25}, Vec2f{0.5, 0.25}, Vec2f{0, 0}, Vec2f{0, 0}, Vec2f{0.5, 0.25}));
  EXPECT_THAT(one.warnings, ElementsAre(HasSubstr("2 of 6 face corners name texture coordinates")));
  expect_error([] { load({kSquare + "f 1//1 2//1 3//1\n"}, true); }, {"key0.obj", "normals that are not there"});
}

TEST(Obj, WhatIsNotReadIsSaidOnce) {
  const MeshData mesh = load(kSquare + "o a\ng b\ns off\nl 1 2\nl 2 3\np 1\nf 1 2 3\n");
  EXPECT_THAT(mesh.warnings, ElementsAre("key0.obj:8: statements 'l' are left out (2 times)",
                                         "key0.obj:10: statements 'p' are left out"));
  expect_error([] { load({kSquare + "f 1 2 3\nl 1 2\n"}, true); }, {"key0.obj:6", "'l'"});
  EXPECT_THAT(load(kSquare + "s 1\nf 1 2 3\n").warnings, ElementsAre(HasSubstr("key0.obj:5: smoothing groups")));
  EXPECT_THAT(load(kSquare + "s 1\nvn 0 0 1\nf 1//1 2//1 3//1\n").warnings, IsEmpty());
  std::string many = kSquare;
  for (int i = 0; i < 5000; ++i) many += "word" + std::to_string(i) + "\n";
  EXPECT_LT(load(many).warnings.size(), 300u);
}

TEST(Obj, VerticesMayHaveColours) {
  const MeshData mesh =
      load("v 0 0 0 1 0.5 0\nv 1 0 0\nv 1 1 0 .25 0 1 .5\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/1 2/1\n");
  ASSERT_THAT(mesh.colors, SizeIs(4));
  const auto linear = [](double code) {  // IEC 61966-2-1
    return static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
  };
  const auto expect_color = [](Vec4f a, Vec4f b) {
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
    EXPECT_NEAR(a.z, b.z, 1e-6);
    EXPECT_NEAR(a.w, b.w, 1e-6);
  };
  expect_color(mesh.colors[0], {1, linear(0.5), 0, 1});
  expect_color(mesh.colors[1], {1, 1, 1, 1});
  expect_color(mesh.colors[2], {linear(0.25), 0, 1, 0.5f});
  expect_color(mesh.colors[3], mesh.colors[0]);  // a corner with another texture coordinate
  const MeshData bytes = load("v 0 0 0 255 51 0\nv 1 0 0 0 0 1\nv 1 1 0\nf 1 2 3\n");
  expect_color(bytes.colors[0], {1, linear(0.2), 0, 1});
  expect_color(bytes.colors[1], {0, 0, linear(1 / 255.0), 1});
  expect_color(bytes.colors[2], {1, 1, 1, 1});
  EXPECT_THAT(load(kSquare + "v 1 2 3 0.5\nf 1 2 3\n").colors, IsEmpty()) << "a weight";
  const MeshData odd = load("v 0 0 0 nan -1 inf\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  for (const Vec4f& c : odd.colors)
    for (const float part : {c.x, c.y, c.z, c.w}) EXPECT_TRUE(part >= 0 && part <= 1) << part;
}

TEST(Obj, KeysShareOneConnectivity) {
  // The files count their normals apart, as exporters do: what one key needs split is split in both. The quad is
  // convex in the first key and concave in the second: the first decides.
  const MeshData mesh =
      load({kSquare + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\nf 1//1 4//1 3//1\n",
            "v 0 0 0\nv 1 0 0\nv 0.1 0.1 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1 4//1\nf 1//2 4//1 3//1\n"});
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{4, 3, 2}));
  ASSERT_EQ(mesh.positions.size(), 2u);
  ASSERT_EQ(mesh.normals.size(), 2u);
  EXPECT_EQ(mesh.positions[1].size(), 5u);
  EXPECT_EQ(mesh.normals[0][4], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.normals[1][4], (Vec3f{1, 0, 0}));
}

TEST(Obj, ABadVertexAtAnyKeyDropsItsTriangles) {
  const MeshData mesh =
      load({kSquare + "f 1 2 3\nf 1 3 4\n", "v 0 0 0\nv nan 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"});
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 2, 3}));
  EXPECT_THAT(mesh.prim_ids, ElementsAre(1));
  EXPECT_EQ(mesh.warnings.size(), 1u);
}

TEST(Obj, KeysOfOtherConnectivityAreRefused) {
  const std::string one = kSquare + "f 1 2 3\nf 1 3 4\n";
  expect_error([&] { load({one, kSquare + "f 1 2 3\n"}); }, {"key1.obj: has 1 faces, key0.obj has 2"});
  expect_error([&] { load({one, one + "v 1 1 1\n"}); }, {"key1.obj: has 5 vertices, key0.obj has 4"});
  expect_error(
      [&] {
        load({one, kSquare + "f 1 2 3 4\nf 1 2 3\n"});
      },
      {"key1.obj: has 7 face corners, key0.obj has 6"});
  expect_error([&] { load({one, kSquare + "f 1 2 3\nf 1 4 3\n"}); }, {"key1.obj: its faces name other vertices"});
}

TEST(Obj, AByteOrderMarkHidesNothing) {
  EXPECT_THAT(load("\xef\xbb\xbf" + kSquare + "f 1 2 3\n").positions, ElementsAre(SizeIs(4)));
}

TEST(Obj, MalformedLinesNameTheirNumber) {
  expect_error([] { load("v 0 0 0\n\nv 1 2\n"); }, {"key0.obj:3", "a number is missing"});
  expect_error([] { load("v 0 0 0\nv 1 \\\n2 \\\nx\nv 0 0 0\n"); }, {"key0.obj:2", "'x' is not a number"});
  expect_error([] { load("v 0 0 1,5\n"); }, {"key0.obj:1", "'1,5' is not a number"});
  expect_error([] { load(""); }, {"key0.obj", "has no vertices"});
  expect_error([] { load(std::string("\xfe\xff\0v\0 \0\n", 8)); }, {"has no vertices"});
}

TEST(Obj, NumbersDoNotDependOnTheLocale) {
  const std::string old = std::setlocale(LC_ALL, nullptr);
  const bool has_comma = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  const MeshData mesh = load("v 0.5 1e-3 16777217\nf 1 1 1\n");
  std::setlocale(LC_ALL, old.c_str());
  EXPECT_EQ(mesh.positions[0][0], (Vec3f{0.5f, 1e-3f, 16777216.0f})) << (has_comma ? "decimal comma" : "C locale only");
}

}  // namespace
}  // namespace kairos
