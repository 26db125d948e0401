// Triangles and attributes of glTF meshes.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<float> kSquarePoints = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

Scene square_with(int mode, nlohmann::json more = nlohmann::json::object(), const LoadOptions& options = {}) {
  GltfBuilder gltf;
  more["attributes"]["POSITION"] = gltf.accessor(kSquarePoints, "VEC3");
  more["mode"] = mode;
  gltf.mesh_node(more);
  return gltf.parse(options);
}

TEST(GltfMesh, ListsStripsAndFansKeepTheirWinding) {
  EXPECT_THAT(square_with(4).meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(square_with(5).meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  EXPECT_THAT(square_with(6).meshes[0].triangles, ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}));
}

TEST(GltfMesh, PointsAndLinesAreLeftOutWithAWarning) {
  for (const int mode : {0, 1, 2, 3}) {
    const Scene scene = square_with(mode);
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("points and lines")));
  }
  EXPECT_THROW(square_with(7), Error);
}

template <class T>
std::vector<Triangle> indexed(const std::vector<T>& indices) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor(kSquarePoints, "VEC3")}}},
                  {"indices", gltf.accessor(indices, "SCALAR")}});
  return gltf.parse().meshes[0].triangles;
}

TEST(GltfMesh, IndicesOfAnyWidth) {
  EXPECT_THAT(indexed<uint8_t>({0, 1, 2, 3, 2, 1}), ElementsAre(Triangle{0, 1, 2}, Triangle{3, 2, 1}));
  EXPECT_THAT(indexed<uint16_t>({0, 1, 2, 3, 2, 1}), ElementsAre(Triangle{0, 1, 2}, Triangle{3, 2, 1}));
  EXPECT_THAT(indexed<uint32_t>({0, 1, 2, 3, 2, 1}), ElementsAre(Triangle{0, 1, 2}, Triangle{3, 2, 1}));
  EXPECT_THROW(indexed<int16_t>({0, 1, 2}), Error);
  EXPECT_THROW(indexed<float>({0, 1, 2}), Error);
}

TEST(GltfMesh, TrianglesBeyondTheVerticesAreDroppedAndTheOthersKeepTheirNumbers) {
  GltfBuilder gltf;
  const std::vector<uint16_t> indices = {0, 1, 2, 0, 4, 1, 1, 2, 3, 65535, 0, 1, 3, 2, 0};
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor(kSquarePoints, "VEC3")}}},
                  {"indices", gltf.accessor(indices, "SCALAR")}});
  const Scene scene = gltf.parse();
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 2, 3}, Triangle{3, 2, 0}));
  EXPECT_THAT(scene.meshes[0].prim_ids, ElementsAre(0u, 2u, 4u));
  EXPECT_THAT(scene.warnings, ElementsAre(AllOf(HasSubstr("dropped"), HasSubstr("2 times"))));
  LoadOptions strict;
  strict.strict = true;
  EXPECT_THROW(gltf.parse(strict), Error);
}

TEST(GltfMesh, SparseAccessorsReplaceElements) {
  GltfBuilder gltf;
  const int indices = gltf.view<uint16_t>({1, 3}), values = gltf.view<float>({7, 8, 9, 4, 5, 6});
  const nlohmann::json sparse = {{"count", 2},
                                 {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                 {"values", {{"bufferView", values}}}};
  const int dense = gltf.accessor(kSquarePoints, "VEC3");
  gltf.root["accessors"][static_cast<size_t>(dense)]["sparse"] = sparse;
  const int zeros =
      gltf.push("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"sparse", sparse}});
  gltf.mesh_node({{"attributes", {{"POSITION", dense}}}, {"mode", 5}});
  gltf.mesh_node({{"attributes", {{"POSITION", zeros}}}, {"mode", 5}});
  const Scene scene = gltf.parse();
  EXPECT_THAT(positions_at(scene, 0, Side::after, 0),
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{7, 8, 9}, Vec3d{0, 1, 0}, Vec3d{4, 5, 6}));
  EXPECT_THAT(positions_at(scene, 0, Side::after, 1),
              ElementsAre(Vec3d{0, 0, 0}, Vec3d{7, 8, 9}, Vec3d{0, 0, 0}, Vec3d{4, 5, 6}));
  gltf.root["accessors"][static_cast<size_t>(zeros)]["count"] = 3;
  EXPECT_THROW(gltf.parse(), Error) << "element 3 does not exist";
}

TEST(GltfMesh, NormalisedAndPlainIntegersAreScaledAsTheSpecificationSays) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes",
                   {{"POSITION", gltf.accessor<int16_t>({32767, -32767, -32768, 16384, 0, 1, 0, 0, 0}, "VEC3", true)},
                    {"TEXCOORD_0", gltf.accessor<uint8_t>({255, 0, 51, 102, 0, 1}, "VEC2", true)}}}});
  gltf.mesh_node(
      {{"attributes", {{"POSITION", gltf.accessor<int8_t>({127, -128, 5, 0, 0, 0, 0, 0, 0}, "VEC3", true)}}}});
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor<uint16_t>({65535, 3, 5, 0, 0, 0, 0, 0, 0}, "VEC3")}}}});
  const Scene scene = gltf.parse();
  const auto shorts = positions_at(scene, 0, Side::after, 0);
  EXPECT_EQ(shorts[0], (Vec3d{1, -1, -1}));
  EXPECT_NEAR(shorts[1].x, 16384.0 / 32767, 1e-7);
  EXPECT_NEAR(shorts[1].z, 1.0 / 32767, 1e-10);
  EXPECT_THAT(scene.meshes[0].uvs, ElementsAre(Vec2f{1, 0}, Vec2f{51 / 255.0f, 102 / 255.0f}, Vec2f{0, 1 / 255.0f}));
  const Vec3d bytes = positions_at(scene, 0, Side::after, 1)[0];
  EXPECT_EQ(bytes.x, 1);
  EXPECT_EQ(bytes.y, -1) << "-128 counts as -127";
  EXPECT_NEAR(bytes.z, 5.0 / 127, 1e-7);
  EXPECT_EQ(positions_at(scene, 0, Side::after, 2)[0], (Vec3d{65535, 3, 5}));
}

TEST(GltfMesh, InterleavedAttributesFollowTheStride) {
  GltfBuilder gltf;
  const int view = gltf.view<float>({0, 0, 0, 0.5, 0.25, 1, 0, 0, 0.75, 1, 0, 1, 0, 0, 0}, 20);
  const int positions =
      gltf.push("accessors", {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  const int uvs = gltf.push(
      "accessors", {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
  gltf.mesh_node({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}});
  const Scene scene = gltf.parse();
  EXPECT_THAT(positions_at(scene, 0), ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}));
  EXPECT_THAT(scene.meshes[0].uvs, ElementsAre(Vec2f{0.5, 0.25}, Vec2f{0.75, 1}, Vec2f{0, 0}));
}

TEST(GltfMesh, AMirroredNodeKeepsItsFrontInFront) {
  for (const double x : {1.0, -1.0}) {
    GltfBuilder gltf;
    gltf.mesh_node({{"attributes",
                     {{"POSITION", gltf.accessor<float>({0, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3")},
                      {"NORMAL", gltf.accessor<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3")}}}},
                   {{"scale", {x, 2, 1}}});
    const Scene scene = gltf.parse();
    const auto p = positions_at(scene, 0);
    const Triangle t = scene.meshes[0].triangles[0];
    const Vec3d geometric = normalize(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    EXPECT_EQ(geometric, (Vec3d{x, 0, 0})) << "what faced +x in the mesh faces the mirrored way";
    EXPECT_EQ(normals_at(scene, 0)[0], (Vec3f{static_cast<float>(x), 0, 0}));
  }
}

TEST(GltfMesh, NormalsStandUprightOnStretchedSurfaces) {
  GltfBuilder gltf;
  const float half = std::sqrt(0.5f);
  gltf.mesh_node({{"attributes",
                   {{"POSITION", gltf.accessor<float>({1, 0, 0, 0, 1, 0, 0, 1, 1}, "VEC3")},
                    {"NORMAL", gltf.accessor<float>({half, half, 0, half, half, 0, half, half, 0}, "VEC3")}}}},
                 {{"scale", {3, 1, 1}}});
  const Scene scene = gltf.parse();
  const auto p = positions_at(scene, 0);
  EXPECT_NEAR(dot(to_double(normals_at(scene, 0)[0]), p[1] - p[0]), 0, 1e-6);
}

TEST(GltfMesh, InstancesShareAMeshAndHaveNamesOfTheirOwn) {
  GltfBuilder gltf;
  const int first = gltf.triangle_node();
  gltf.root["meshes"][0]["name"] = "leaf";
  gltf.push("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  gltf.push("nodes", {{"mesh", 0}, {"name", "top"}});
  (void)first;
  const Scene scene = gltf.parse();
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].name, "leaf");
  EXPECT_EQ(scene.meshes[1].name, "leaf.1");
  EXPECT_EQ(scene.meshes[2].name, "top");
  EXPECT_EQ(positions_at(scene, 0, Side::after, 1)[0].x, 5);
}

TEST(GltfMesh, ScenesArePickedByNameOrIndex) {
  GltfBuilder gltf;
  gltf.triangle_node({0, 0, 0, 1, 0, 0, 0, 1, 0}, {{"name", "a"}});
  gltf.push("nodes", {{"mesh", 0}, {"name", "b"}});
  gltf.root["scenes"] = {{{"name", "left"}, {"nodes", {0}}}, {{"name", "right"}, {"nodes", {1}}}};
  const auto shown = [&](const std::string& name) {
    LoadOptions options;
    options.gltf_scene = name;
    return gltf.parse(options).meshes.at(0).name;
  };
  EXPECT_EQ(shown(""), "a");
  EXPECT_EQ(shown("right"), "b");
  EXPECT_EQ(shown("1"), "b");
  EXPECT_THROW(shown("middle"), Error);
  gltf.root["scene"] = 1;
  EXPECT_EQ(shown(""), "b");
}

TEST(GltfMesh, ZeroNormalsAreLeftOut) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes",
                   {{"POSITION", gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")},
                    {"NORMAL", gltf.accessor<float>({0, 0, 1, 0, 0, 0, 0, 0, 1}, "VEC3")}}}});
  const Scene scene = gltf.parse();
  EXPECT_FALSE(scene.meshes[0].motion->has_normals());
  EXPECT_EQ(scene.warnings.size(), 1u);
}

}  // namespace
}  // namespace kairos
