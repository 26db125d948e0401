// The glTF container, its buffers, and what hostile files try.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <kairos/error.h>

#include "error_matchers.h"
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
  EXPECT_THAT(refusal_of((folder_ / "outside.bin").string()), HasSubstr("leaves the folder"));
  EXPECT_THAT(refusal_of("../../../../../../etc/passwd"), HasSubstr("leaves the folder"));
  std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "scene/link.bin");
  EXPECT_THAT(refusal_of("link.bin"), HasSubstr("leaves the folder"));
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

TEST(GltfDocument, InstancesShareTriangles) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes", {{"POSITION", gltf.accessor<float>(std::vector<float>(90'000, 1), "VEC3")}}}});
  for (int i = 0; i < 100'000; ++i) gltf.push("nodes", {{"mesh", 0}});
  LoadOptions options;
  options.memory_budget = 1000000;
  const Scene scene = gltf.parse(options);
  EXPECT_EQ(scene.meshes.size(), 100'001u);
  EXPECT_EQ(scene.meshes.front().triangles.identity(), scene.meshes.back().triangles.identity());
}

TEST(GltfDocument, WhatAnExtensionRequiresIsSupportedOrRefusedByName) {
  GltfBuilder gltf = triangle();
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(refusal(gltf.text()), "");
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_gaussian_splatting"};
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("'KHR_gaussian_splatting'"));
  gltf.root["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_EQ(refusal(gltf.text()), "") << "the shapes are right";
  gltf.root["extensionsUsed"] = {"KHR_texture_basisu", "EXT_unheard_of"};
  EXPECT_THAT(gltf.parse().warnings, testing::ElementsAre(HasSubstr("the extension 'EXT_unheard_of' is left out")));
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
  for (const char* old : {R"({"asset": {"version": "1.0"}, "scene": "defaultScene"})", R"({"asset": {"version": 1.0}})",
                          R"({"scene": "defaultScene", "scenes": {}})"})
    EXPECT_THAT(refusal(old), HasSubstr("this is glTF 1.0, and only 2.0 is supported")) << old;
  EXPECT_THAT(refusal("<!DOCTYPE html><html></html>"), HasSubstr("test.gltf: is an HTML page"));
  EXPECT_THAT(refusal("version https://git-lfs.github.com/spec/v1\noid sha256:0\n"), HasSubstr("Git LFS pointer"));
  gltf = triangle();
  gltf.root["skins"] = nlohmann::json::array({nlohmann::json::object()});
  EXPECT_THAT(refusal(gltf.text()), HasSubstr("test.gltf: skins[0]: joints is missing"));
  EXPECT_THAT(refusal("{}"), HasSubstr("test.gltf"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("test.gltf"));
  EXPECT_THAT(refusal("{\"asset\""), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal(""), HasSubstr("test.gltf"));
}

TEST(GltfDocument, WhatNothingUsesMayBeMissing) {
  GltfBuilder gltf = triangle();
  gltf.text();
  nlohmann::json full = nlohmann::json::parse(gltf.text());
  full["buffers"].push_back({{"byteLength", 100}});
  full["buffers"].push_back({{"byteLength", 100}, {"uri", "absent.bin"}});
  full["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 100}});
  full["bufferViews"].push_back({{"buffer", 2}, {"byteLength", 100}});
  EXPECT_EQ(refusal(full.dump()), "");
  full["accessors"][0]["bufferView"] = 1;
  EXPECT_THAT(refusal(full.dump()), HasSubstr("buffers[1]: has no uri"));
  full["accessors"][0]["bufferView"] = 2;
  EXPECT_THAT(refusal(full.dump()), HasSubstr("buffers[2]: names the file 'absent.bin'"));
}

TEST(GltfDocument, EmptyPrimitivesAreLeftOutAndNamed) {
  GltfBuilder gltf = triangle();
  nlohmann::json empty = {{"attributes", {{"POSITION", 1}}}, {"indices", 2}};
  gltf.push("accessors",
            {{"bufferView", 0}, {"byteOffset", 96}, {"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
  gltf.push("accessors",
            {{"bufferView", 0}, {"byteOffset", 96}, {"componentType", 5125}, {"count", 0}, {"type", "SCALAR"}});
  gltf.root["meshes"][0]["primitives"].push_back(empty);
  const Scene scene = gltf.parse();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.warnings, testing::ElementsAre(HasSubstr("primitives[1]: an empty primitive is left out")));
}

/// One rule for everything: what the file holds and the reader does not ask for is named once.
TEST(GltfDocument, NothingIsPassedOverInSilence) {
  const auto warnings = [](const char* array, const nlohmann::json& extra) {
    GltfBuilder gltf = triangle();
    gltf.root["materials"] = nlohmann::json::array({nlohmann::json::object()});
    gltf.root[array][0].update(extra);
    const Scene scene = gltf.parse();
    LoadOptions strict;
    strict.strict = true;
    if (scene.warnings.empty())
      EXPECT_NO_THROW(gltf.parse(strict)) << array;
    else
      EXPECT_THROW(gltf.parse(strict), Error) << array;
    return scene.warnings;
  };
  for (const char* array : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) {
    const std::string place = std::string(array) + "[0]: ";
    EXPECT_THAT(warnings(array, {{"wings", {{"feathers", 3}}}}),
                testing::ElementsAre(HasSubstr("test.gltf: " + place + "'wings' is left out")));
    EXPECT_THAT(warnings(array, {{"extensions", {{"EXT_wings", {{"feathers", 3}}}}}}),
                testing::ElementsAre(HasSubstr(place + "the extension 'EXT_wings' is left out")));
    EXPECT_THAT(warnings(array, {{"extras", {{"feathers", 3}}}, {"name", "bird"}}), testing::IsEmpty());
  }
  EXPECT_THAT(warnings("nodes", {{"extensions", {{"KHR_node_visibility", {{"visible", true}, {"half", 1}}}}}}),
              testing::ElementsAre(HasSubstr("nodes[0].extensions.KHR_node_visibility: 'half' is left out")));
  GltfBuilder many = triangle();
  for (int i = 0; i < 1000; ++i) many.push("nodes", {{"tail" + std::to_string(i), 1}, {"wings", 2}});
  EXPECT_LT(many.parse().warnings.size(), 210u) << "a hostile file does not flood the log";
  EXPECT_THAT(many.parse().warnings, testing::Contains(HasSubstr("'wings' is left out")));
  EXPECT_THAT(many.parse().warnings.back(), HasSubstr("not shown"));
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
