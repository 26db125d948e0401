// Copies of a mesh (EXT_mesh_gpu_instancing), and nodes that hide (KHR_node_visibility).
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

void expect_at(Vec3d a, Vec3d b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6) << "component " << c;
}

TEST(GltfInstances, StandWhereTheyAreToldAndMoveWithTheirNode) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {0, 1}, {0, 0, 0, 0, 10, 0}, "VEC3");
  const float half = std::sqrt(0.5f);
  gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", gltf.accessor<float>({-5, 0, 0, 0, 0, 0, 5, 0, 0}, "VEC3")},
      {"ROTATION", gltf.accessor<float>({0, 0, 0, 1, 0, 0, half, half, 0, 0, 0, 1}, "VEC4")},
      {"SCALE", gltf.accessor<float>({1, 1, 1, 2, 2, 2, -1, 1, 1}, "VEC3")},
      {"_ID", gltf.accessor<float>({0, 1, 2}, "SCALAR")}};
  const Scene scene = gltf.parse();
  EXPECT_THAT(scene.warnings, IsEmpty());
  ASSERT_EQ(scene.meshes.size(), 3u) << "and none at the node itself";
  expect_at(positions_at(scene, 0, Side::after, 0)[1], {-4, 0, 0});
  expect_at(positions_at(scene, 0.5, Side::after, 0)[1], {-4, 5, 0});
  expect_at(positions_at(scene, 0, Side::after, 1)[1], {0, 2, 0});
  expect_at(positions_at(scene, 1, Side::after, 1)[1], {0, 12, 0});
  expect_at(positions_at(scene, 0, Side::after, 2)[1], {4, 0, 0});
  EXPECT_EQ(scene.meshes[0].triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(scene.meshes[2].triangles[0], (Triangle{0, 2, 1})) << "a mirrored one shows the same side";
  EXPECT_FALSE(scene.meshes[2].motion->is_static(0, 1));
  EXPECT_TRUE(scene.meshes[1].motion->is_linear_between_kinks());

  auto& attributes = gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["COLOR_0"] = attributes["TRANSLATION"];
  EXPECT_THAT(gltf.parse().warnings, testing::ElementsAre(HasSubstr("'COLOR_0' of instances is left out")));
  attributes["SCALE"] = gltf.accessor<float>({1, 1, 1}, "VEC3");
  EXPECT_THROW(gltf.parse(), Error);
  attributes = {{"TRANSLATION", 99}};
  EXPECT_THROW(gltf.parse(), Error);
}

TEST(GltfInstances, CountAgainstWhatAFileMayGrowTo) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor<float>(std::vector<float>(90'000, 1), "VEC3")}}}});
  const int places =
      gltf.push("accessors", {{"componentType", 5126}, {"count", 1'000'000}, {"type", "VEC3"}});  // zeros
  gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}};
  try {
    gltf.parse();
    FAIL() << "30 000 million triangles";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("memory"));
  }
}

TEST(GltfVisibility, WhoHidesHidesAllBelowButCameras) {
  GltfBuilder gltf;
  gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  gltf.triangle_node();
  gltf.triangle_node({0, 0, 1, 1, 0, 1, 0, 1, 1});
  gltf.push("nodes", {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"children", {1}}});
  gltf.push("nodes", {{"children", {2}}});
  EXPECT_EQ(gltf.parse().meshes.size(), 2u);
  gltf.root["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const Scene scene = gltf.parse();
  ASSERT_EQ(scene.meshes.size(), 1u);
  expect_at(positions_at(scene, 0)[0], {0, 0, 0});
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_TRUE(scene.lights.empty());
  gltf.root["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"] = true;
  EXPECT_EQ(gltf.parse().meshes.size(), 2u);
}

}  // namespace
}  // namespace kairos
