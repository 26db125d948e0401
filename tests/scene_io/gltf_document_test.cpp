// The glTF container, its buffers, and what hostile files try.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::HasSubstr;

/// The message with which the text is refused, or "" when it is not.
std::string refusal(const std::string& text, const std::string& folder = "") {
  try {
    GltfBuilder::parse_text(text, {}, folder);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
}

GltfBuilder triangle() {
  GltfBuilder gltf;
  gltf.triangle_node();
  return gltf;
}

TEST(GltfDocument, ABinaryFileHoldsTheSameAsATextFile) {
  const GltfBuilder gltf = triangle();
  const std::vector<uint8_t> glb = gltf.glb();
  const Scene scene = parse_gltf(glb, "test.glb", "");
  EXPECT_EQ(positions_at(scene, 0), positions_at(gltf.parse(), 0));
  for (size_t length = 0; length < glb.size(); ++length)
    EXPECT_THROW(parse_gltf(std::span(glb).first(length), "test.glb", ""), Error)
        << length << " bytes of " << glb.size();
}

class GltfFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "scene");
    const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 9, 9, 9};
    for (const char* name : {"scene/my data.bin", "outside.bin"})
      std::ofstream(folder_ / name, std::ios::binary)
          .write(reinterpret_cast<const char*>(corners.data()), static_cast<std::streamsize>(corners.size() * 4));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string refusal_of(const std::string& uri) {
    GltfBuilder gltf = triangle();
    gltf.root["buffers"] = {{{"uri", uri}, {"byteLength", 36}}};
    return refusal(gltf.text(), (folder_ / "scene").string());
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("kairos_gltf_" + std::to_string(::getpid()));
};

TEST_F(GltfFolder, BuffersAreFilesBesideTheScene) {
  EXPECT_EQ(refusal_of("my%20data.bin"), "") << "longer than its byteLength, which is allowed";
  EXPECT_THAT(refusal_of("absent.bin"), HasSubstr("absent.bin"));
}

TEST_F(GltfFolder, NothingOutsideOfTheFolderIsRead) {
  for (const std::string uri : {"../outside.bin", "%2e%2e/outside.bin", "..%2Foutside.bin", "x/../../outside.bin"})
    EXPECT_THAT(refusal_of(uri), HasSubstr("test.gltf: buffers[0]: path")) << uri;
  EXPECT_THAT(refusal_of((folder_ / "outside.bin").string()), HasSubstr("absolute"));
  EXPECT_THAT(refusal_of("../../../../../../etc/passwd"), HasSubstr("leaves the scene's folder"));
  std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "scene/link.bin");
  EXPECT_THAT(refusal_of("link.bin"), HasSubstr("leaves the scene's folder"));
}

TEST(GltfDocument, NoFileIsReadWithoutAFolder) {
  GltfBuilder gltf = triangle();
  gltf.root["buffers"] = {{{"uri", "/etc/passwd"}, {"byteLength", 36}}};
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("buffers[0]"));
}

TEST(GltfDocument, CyclesAndSharedChildrenAreRefused) {
  GltfBuilder self = triangle();
  self.root["nodes"][0]["children"] = {0};
  EXPECT_THAT(refusal(self.text()), HasSubstr("test.gltf: nodes[0]: is its own ancestor"));
  GltfBuilder ring = triangle();
  ring.push("nodes", {{"children", {2}}});
  ring.push("nodes", {{"children", {1}}});
  EXPECT_THAT(refusal(ring.text()), HasSubstr("nodes[1]: is its own ancestor"));
  GltfBuilder shared = triangle();
  shared.push("nodes", {{"children", {0}}});
  EXPECT_EQ(refusal(shared.text()), "");
  shared.push("nodes", {{"children", {0}}});
  EXPECT_THAT(refusal(shared.text()), HasSubstr("nodes[0]: has more than one parent"));
  GltfBuilder missing = triangle();
  missing.root["nodes"][0]["children"] = {7};
  EXPECT_THAT(refusal(missing.text()), HasSubstr("nodes[0]: names child 7"));
}

TEST(GltfDocument, DepthIsLimitedInNodesAndInJson) {
  const auto chain = [](int depth) {
    GltfBuilder gltf = triangle();
    for (int i = 1; i < depth; ++i) gltf.push("nodes", {{"children", {i - 1}}});
    return refusal(gltf.text());
  };
  EXPECT_EQ(chain(1000), "");
  EXPECT_THAT(chain(1001), HasSubstr("1000 levels"));
  const auto nested = [](size_t depth) {
    return refusal(R"({"asset": {"version": "2.0"}, "extras": )" + std::string(depth, '[') + std::string(depth, ']') +
                   "}");
  };
  EXPECT_EQ(nested(60), "");
  EXPECT_THAT(nested(70), HasSubstr("64 levels"));
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("64 levels"));
}

TEST(GltfDocument, AccessorsStayInsideTheirBuffers) {
  const auto broken = [](const char* array, const char* key, nlohmann::json value) {
    GltfBuilder gltf = triangle();
    gltf.root[array][0][key] = std::move(value);
    return refusal(gltf.text());
  };
  EXPECT_EQ(broken("accessors", "count", 3), "");
  EXPECT_THAT(broken("accessors", "count", 4), HasSubstr("test.gltf: accessors[0]: reaches beyond"));
  EXPECT_THAT(broken("accessors", "byteOffset", 4), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("accessors", "count", 1ull << 52), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("accessors", "count", 6148914691236517206ull), HasSubstr("accessors[0].count"))
      << "x 12 wraps to 8";
  EXPECT_THAT(broken("accessors", "byteOffset", (1ull << 53) - 4), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("accessors", "count", -3), HasSubstr("accessors[0].count"));
  EXPECT_THAT(broken("accessors", "bufferView", 1), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("accessors", "componentType", 5124), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("accessors", "type", "VEC4"), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("bufferViews", "byteLength", 40), HasSubstr("bufferViews[0]: reaches beyond"));
  EXPECT_THAT(broken("bufferViews", "byteOffset", 4), HasSubstr("bufferViews[0]"));
  EXPECT_THAT(broken("bufferViews", "byteStride", 8), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken("bufferViews", "buffer", 3), HasSubstr("bufferViews[0]"));
}

TEST(GltfDocument, CountsWithoutBytesBehindThemAreNotAllocated) {
  GltfBuilder gltf = triangle();
  gltf.root["accessors"][0].erase("bufferView");
  gltf.root["accessors"][0]["count"] = 4'000'000'000u;  // 48 GB of zeros, legal as such
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("memory"));
}

TEST(GltfDocument, InstancesDoNotMultiplyMemoryWithoutLimit) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor<float>(std::vector<float>(90'000, 1), "VEC3")}}}});
  for (int i = 0; i < 100'000; ++i) gltf.push("nodes", {{"mesh", 0}});
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("memory"));
}

TEST(GltfDocument, WhatAnExtensionRequiresIsSupportedOrRefusedByName) {
  GltfBuilder gltf = triangle();
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(refusal(gltf.text()), "");
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization", "EXT_meshopt_compression"};
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("'EXT_meshopt_compression'"));
  gltf.root["extensionsRequired"] = {"KHR_materials_clearcoat"};
  gltf.root["extensionsUsed"] = {"KHR_materials_clearcoat"};
  EXPECT_THAT(gltf.parse().warnings, testing::ElementsAre(HasSubstr("'KHR_materials_clearcoat'")));
}

TEST(GltfDocument, WrongTypesAreNamedByTheirPath) {
  GltfBuilder gltf = triangle();
  gltf.root["nodes"][0]["mesh"] = "0";
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("test.gltf: nodes[0].mesh: must be a whole number"));
  gltf.root["nodes"][0]["mesh"] = 0.0;
  EXPECT_EQ(refusal(gltf.text()), "") << "JSON does not tell 0.0 from 0";
  gltf.root["nodes"][0]["mesh"] = 5;
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("nodes[0]: names mesh 5"));
  gltf.root["nodes"] = 3;
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("nodes: must be an array"));
  EXPECT_THAT(refusal("{\"asset\": {\"version\": \"1.0\"}}"), HasSubstr("asset.version"));
  EXPECT_THAT(refusal("{}"), HasSubstr("test.gltf"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("test.gltf"));
  EXPECT_THAT(refusal("{\"asset\""), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal(""), HasSubstr("test.gltf"));
}

TEST(GltfDocument, AttributesMustAgreeOnTheNumberOfVertices) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes",
                   {{"POSITION", gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")},
                    {"TEXCOORD_0", gltf.accessor<float>({0, 0, 1, 1}, "VEC2")}}}});
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("TEXCOORD_0 has 2 elements"));
}

}  // namespace
}  // namespace kairos
