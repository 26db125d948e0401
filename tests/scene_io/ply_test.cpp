#include "scene_io/ply/ply.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"
#include "seed.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MeshData load_ply(const std::string& file) { return make_mesh_data({parse_ply(file, "a.ply")}, false); }

/// Writes the same values as ascii, little-endian or big-endian.
struct Writer {
  std::string format, body;

  template <class T>
  void put(T value) {
    if (format == "ascii") {
      body += fmt::format("{} ", value);
      return;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if ((format == "binary_big_endian") == (std::endian::native == std::endian::little))
      std::reverse(bytes, bytes + sizeof(T));
    body.append(bytes, sizeof(T));
  }
  std::string file(const std::string& header) const {
    return "ply\nformat " + format + " 1.0\n" + header + "end_header\n" + body;
  }
};

/// Every scalar type, lists to pass over before, between and after what counts, an unknown element in between.
std::string everything(const std::string& format, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-10, 10);
  Writer w{format, {}};
  for (int i = 0; i < 5; ++i) {
    w.put(uniform(random));
    w.put<uint8_t>(2);
    w.put(static_cast<float>(uniform(random)));
    w.put(static_cast<float>(uniform(random)));
    w.put(static_cast<float>(uniform(random)));
    w.put(static_cast<int16_t>(-300 + i));
    w.put(static_cast<int8_t>(-i));
    w.put(static_cast<uint16_t>(60000 + i));
    w.put(1.0f);
    w.put(0.0f);
    w.put(0.0f);
    w.put(static_cast<float>(uniform(random)));
    w.put(uniform(random));
  }
  for (int i = 0; i < 2; ++i) {
    w.put<uint16_t>(3);
    for (int k = 0; k < 3; ++k) w.put<double>(k);
  }
  const std::vector<std::vector<uint32_t>> faces{{0, 1, 2}, {0, 1, 2, 3}, {4, 3, 1}};
  for (const auto& face : faces) {
    w.put<uint8_t>(7);
    w.put(static_cast<int32_t>(face.size()));
    for (const uint32_t v : face) w.put(v);
    w.put<uint32_t>(1);
    w.put(0.5f);
  }
  return w.file(
      "comment hello\nobj_info there\nelement vertex 5\nproperty double x\nproperty list uchar float junk\nproperty "
      "float q\n"
      "property short y\nproperty char z\nproperty ushort w\nproperty float32 nx\nproperty float ny\nproperty float "
      "nz\n"
      "property float s\nproperty float64 t\nelement other 2\nproperty list uint16 double values\n"
      "element face 3\nproperty uint8 flags\nproperty list int32 uint32 vertex_index\nproperty list uint float uv\n");
}

TEST(Ply, AsciiAndBothBinaryFormatsAgree) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE("seed " + std::to_string(seed));
  const MeshData ascii = load_ply(everything("ascii", seed));
  EXPECT_EQ(ascii.positions.at(0).at(3).y, -297);
  EXPECT_EQ(ascii.positions.at(0).at(3).z, -3);
  EXPECT_EQ(ascii.normals.at(0).at(0), (Vec3f{1, 0, 0}));
  EXPECT_EQ(ascii.uvs.size(), 5u);
  EXPECT_EQ(ascii.triangles.size(), 4u);
  EXPECT_EQ(ascii.triangles.back(), (Triangle{4, 3, 1}));
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const MeshData binary = load_ply(everything(format, seed));
    EXPECT_EQ(binary.positions, ascii.positions) << format;
    EXPECT_EQ(binary.normals, ascii.normals) << format;
    EXPECT_EQ(binary.uvs, ascii.uvs) << format;
    EXPECT_EQ(binary.triangles, ascii.triangles) << format;
    EXPECT_EQ(binary.warnings, ascii.warnings);
  }
}

TEST(Ply, AFileCutAnywhereIsRefused) {
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string file = everything(format, 1);
    for (size_t size = 0; size < file.size(); ++size) expect_error([&] { load_ply(file.substr(0, size)); }, {"a.ply"});
  }
}

std::string ascii(const std::string& header, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "property list uchar int vertex_indices\n";

TEST(Ply, LineEndsOfAnyKind) {
  const std::string file =
      ascii("element vertex 3\n" + kXyz + "element face 1\n" + kFace, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string other;
    for (const char c : file) c == '\n' ? other += end : other += c;
    EXPECT_THAT(load_ply(other).triangles, ElementsAre(Triangle{0, 1, 2}));
  }
}

TEST(Ply, ABinaryBodyMayBeginLikeALineEnd) {
  Writer w{"binary_little_endian", {}};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) w.put<uint8_t>(10);  // '\n'
  w.put<uint8_t>(3);
  for (const uint8_t v : {0, 1, 2}) w.put(v);
  std::string file = w.file(
      "element vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\n"
      "property list uchar uchar vertex_indices\n");
  for (size_t i = 0; i + 13 < file.size(); ++i)
    if (file[i] == '\n') file[i] = '\r';  // the header's lines end in CR alone
  EXPECT_EQ(load_ply(file).positions.at(0).at(2), (Vec3f{10, 10, 10}));
}

TEST(Ply, TextureCoordinateNames) {
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v"),
                             std::pair("texture_s", "texture_t")}) {
    const MeshData mesh = load_ply(ascii(
        fmt::format("element vertex 1\n{}property float {}\nproperty float {}\n", kXyz, u, v), "0 0 0 0.25 0.75"));
    EXPECT_THAT(mesh.uvs, ElementsAre(Vec2f{0.25, 0.75})) << u;
  }
}

TEST(Ply, TriangleStripsAlternateAndRestart) {
  const MeshData mesh =
      load_ply(ascii("element vertex 5\n" + kXyz + "element tristrips 1\nproperty list int int vertex_indices\n",
                     "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0\n9 0 1 2 3 -1 2 3 4 1\n"));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{2, 3, 4}, Triangle{4, 3, 1}));
}

TEST(Ply, VerticesMayHaveColours) {
  const auto color = [](const std::string& type, const std::string& values, const char* prefix = "") {
    std::string header = "element vertex 3\n" + kXyz;
    for (const char* name : {"red", "green", "blue"}) header += "property " + type + " " + prefix + name + "\n";
    const std::string row = " 0 0 0 " + values;
    const MeshData mesh = load_ply(ascii(header + "element face 1\n" + kFace, row + row + row + " 3 0 1 2"));
    EXPECT_THAT(mesh.warnings, IsEmpty());
    return mesh.colors.at(2);
  };
  const float fifth = std::pow((0.2f + 0.055f) / 1.055f, 2.4f);  // the curve of sRGB
  for (const Vec4f seen :
       {color("uchar", "255 51 0"), color("ushort", "65535 13107 0"), color("float", "1 .2 0"),
        color("int", "255 51 0"), color("double", "7 .2 -1"), color("uint8", "255 51 0", "diffuse_")}) {
    EXPECT_EQ(seen.x, 1);
    EXPECT_NEAR(seen.y, fifth, 1e-6);
    EXPECT_EQ(seen.z, 0);
    EXPECT_EQ(seen.w, 1);
  }
}

TEST(Ply, WhatIsNotReadIsSaidOnce) {
  const std::string file =
      ascii("element vertex 3\n" + kXyz + "property float quality\nproperty list int int more\nelement face 1\n" +
                kFace + "property int flags\nelement edge 1\nproperty int a\nelement none 0\nproperty int a\n",
            "0 0 0 1 0  1 0 0 1 0  0 1 0 1 0  3 0 1 2 7  5");
  EXPECT_THAT(load_ply(file).warnings, ElementsAre("a.ply: properties 'quality' of elements 'vertex' are left out",
                                                   "a.ply: properties 'more' of elements 'vertex' are left out",
                                                   "a.ply: properties 'flags' of elements 'face' are left out",
                                                   "a.ply: elements 'edge' are left out"));
  expect_error([&] { make_mesh_data({parse_ply(file, "a.ply")}, true); }, {"a.ply", "'quality'"});
}

TEST(Ply, BadTrianglesAreDroppedCountedAndReportedOnce) {
  const MeshData mesh =
      load_ply(ascii("element vertex 4\n" + kXyz + "element face 5\n" + kFace,
                     "0 0 0\n1 0 0\n0 1 0\nnan inf 0\n3 0 1 2\n3 0 1 3\n3 0 1 -2\n3 0 1 4\n3 2 1 0\n"));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 0}));
  EXPECT_THAT(mesh.prim_ids, ElementsAre(0, 4));
  EXPECT_THAT(
      mesh.warnings,
      ElementsAre(
          "a.ply: 3 of 5 triangles dropped: 2 with a vertex index out of range, 1 with a vertex that is not finite"));
}

TEST(Ply, ElementsWithoutPropertiesTakeNoTime) {
  const MeshData mesh = load_ply(ascii("element nothing 9000000000000000000\nelement vertex 1\n" + kXyz, "1 2 3"));
  EXPECT_THAT(mesh.positions, ElementsAre(ElementsAre(Vec3f{1, 2, 3})));
}

TEST(Ply, PromisesAreComparedWithTheFileBeforeMemoryIsTaken) {
  expect_error([] { load_ply(ascii("element vertex 4000000000\n" + kXyz, "0 0 0")); },
               {"a.ply", "too short for its 4000000000 elements 'vertex'"});
  Writer w{"binary_little_endian", {}};
  w.put<uint32_t>(4000000000u);
  expect_error([&] { load_ply(w.file("element face 1\nproperty list uint int vertex_indices\n")); },
               {"too short for a list 'vertex_indices' of length 4000000000"});
  expect_error([] { load_ply(ascii("element face 1\n" + kFace, "-1")); }, {"a list 'vertex_indices' of length -1"});
}

TEST(Ply, UnknownHeaderLinesArePassedOver) {
  EXPECT_THAT(load_ply(ascii("Created by someone\nelement vertex 1\n" + kXyz, "1 2 3")).warnings,
              ElementsAre("a.ply:3: header line 'Created ...' passed over", "a.ply: has no triangles"));
}

TEST(Ply, MalformedHeaders) {
  const std::string xyz = "element vertex 1\n" + kXyz;
  expect_error([] { load_ply(""); }, {"a.ply", "is it a PLY file?"});
  expect_error([] { load_ply("ply\nformat ascii 1.0\n"); }, {"a.ply:2", "end_header"});
  expect_error([] { load_ply("ply\nelement vertex 0\nend_header\n"); }, {"no format line"});
  expect_error([] { load_ply("ply\nformat ascii 2.0\nend_header\n"); }, {"a.ply:2", "expected 'format"});
  expect_error([] { load_ply(ascii("property float x\n", "")); }, {"a.ply:3", "before the first element"});
  expect_error([] { load_ply(ascii("element vertex -1\n", "")); }, {"a.ply:3", "element NAME COUNT"});
  expect_error([] { load_ply(ascii("element vertex 1\nproperty half x\n", "")); }, {"a.ply:4", "unknown type 'half'"});
  expect_error([] { load_ply(ascii("element face 1\nproperty list float int vertex_indices\n", "")); },
               {"a.ply:4", "length of a list"});
  expect_error([] { load_ply(ascii("element vertex 1\nproperty float x\n", "1")); }, {"lack one of x, y, z"});
  expect_error([] { load_ply(ascii("element face 0\n" + kFace, "")); }, {"no element 'vertex'"});
  expect_error([&] { load_ply(ascii(xyz + xyz, "1 1 1 1 1 1")); }, {"second element 'vertex'"});
  expect_error([&] { load_ply(ascii(xyz, "1 x 1")); }, {"'x' is not a number"});
}

}  // namespace
}  // namespace kairos
