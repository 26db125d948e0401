// Pictures of a scene: in files, in data URIs and inside a GLB; missing and damaged ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/image.h>
#include <kairos/scene.h>

#include "base/file.h"
#include "error_matchers.h"
#include "gltf_builder.h"
#include "image/texture.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A PNG of 1 x 1 pixels, pure red.
std::vector<uint8_t> red_png(const TempFolder& folder) {
  Image image{1, 1, 0, 0, 1, 1, {}, {}};
  image.channels = {
      {"R", Channel::Storage::colour, {1}}, {"G", Channel::Storage::colour, {0}}, {"B", Channel::Storage::colour, {0}}};
  write_image(image, folder.path("red.png"));
  return read_file(folder.path("red.png"), 1 << 20);
}

void use_image(GltfBuilder& gltf, nlohmann::json image) {
  gltf.triangle_node();
  gltf.root["images"] = nlohmann::json::array({std::move(image)});
  gltf.root["textures"] = nlohmann::json::array({{{"source", 0}}});
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                             {"emissiveTexture", {{"index", 0}}},
                             {"emissiveFactor", {1, 1, 1}}},
                            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
}

void expect_red(const Scene& scene) {
  const Shot shot = make_shot(scene);
  ASSERT_EQ(shot.textures.size(), 3u) << "the file's two materials and glTF's default";
  ASSERT_TRUE(shot.textures[0].base_color);
  EXPECT_EQ(shot.textures[0].base_color->at({0, 0}, 1).colour, (Vec3f{1, 0, 0}));
  EXPECT_EQ(shot.textures[0].base_color, shot.textures[1].base_color) << "read once";
  EXPECT_EQ(shot.textures[0].base_color, shot.textures[0].emission);
  EXPECT_FALSE(shot.textures[2].base_color);
}

TEST(LoadTextures, OfTheEnvironment) {
  const TempFolder folder;
  Image image{2, 1, 0, 0, 2, 1, {}, {}};
  for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, Channel::Storage::colour, {3, 4}});
  write_image(image, folder.path("sky.exr"));
  folder.write("scene.json", R"({"kairos": 1, "lights": [{"type": "constant", "radiance": [1, 1, 1]},
      {"type": "environment", "texture": "sky.exr"}, {"type": "environment", "texture": "none.exr"}]})");
  const auto scene = load_scene({folder.path("scene.json")});
  const Shot shot = make_shot(*scene);
  ASSERT_EQ(shot.light_textures.size(), 3u);
  EXPECT_FALSE(shot.light_textures[0]);
  ASSERT_TRUE(shot.light_textures[1]);
  EXPECT_EQ(shot.light_textures[1]->at({0.75f, 0.5f}, 1).colour, (Vec3f{4, 4, 4}));
  EXPECT_FALSE(shot.light_textures[2]);
  EXPECT_THAT(shot.notes, testing::Contains(HasSubstr("environment picture left out: " + folder.path("none.exr"))));
  ShotOptions options;
  options.textures = false;
  EXPECT_TRUE(make_shot(*scene, options).light_textures.empty());
  options = {};
  options.strict = true;
  expect_error([&] { make_shot(*scene, options); }, {"none.exr"}, ErrorCode::io);
}

TEST(LoadTextures, EqualAreasNeedASquare) {
  const TempFolder folder;
  Image image{2, 1, 0, 0, 2, 1, {}, {}};
  for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, Channel::Storage::colour, {3, 4}});
  write_image(image, folder.path("sky.exr"));
  folder.write("scene.pbrt", "WorldBegin LightSource \"infinite\" \"string filename\" \"sky.exr\"");
  const Shot shot = make_shot(*load_scene({folder.path("scene.pbrt")}));
  EXPECT_FALSE(shot.light_textures.at(0));
  EXPECT_THAT(shot.notes, testing::Contains(HasSubstr("is not square")));
}

TEST(LoadTextures, InsideAGlb) {
  const TempFolder folder;
  GltfBuilder gltf;
  const int view = gltf.view(red_png(folder));
  use_image(gltf, {{"bufferView", view}, {"mimeType", "image/png"}});
  const std::vector<uint8_t> bytes = gltf.glb();
  const Scene scene = parse_gltf(bytes, "test.glb", "", {});
  EXPECT_THAT(scene.warnings, testing::IsEmpty());
  expect_red(scene);

  gltf.root["images"][0]["bufferView"] = 100;
  LoadOptions strict;
  strict.strict = true;
  expect_error([&] { gltf.parse(strict); }, {"images[0]", "buffer view 100"});
  EXPECT_THAT(gltf.parse().warnings, testing::ElementsAre(testing::HasSubstr("a picture is left out: images[0]")));
  gltf.root["images"][0]["bufferView"] = view;
  gltf.root["bufferViews"][view]["byteLength"] = 1 << 20;
  expect_error([&] { gltf.parse(strict); }, {"bufferViews", "beyond"});
}

TEST(LoadTextures, InADataUri) {
  const TempFolder folder;
  std::string uri = "data:image/png,";
  for (const uint8_t byte : red_png(folder)) {
    const char* digits = "0123456789abcdef";
    uri += {'%', digits[byte >> 4], digits[byte & 15]};
  }
  GltfBuilder gltf;
  use_image(gltf, {{"uri", uri}});
  expect_red(gltf.parse());
}

TEST(LoadTextures, BesideANativeFile) {
  const TempFolder folder;
  red_png(folder);
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  const std::string path = folder.write("scene.json", R"({"kairos": 1, "meshes": [{"keys": ["a.obj"], "material": "m"}],
    "materials": {"m": {"base_color_texture": "red.png", "emission": [1, 1, 1], "emission_texture": "red.png",
                        "metallic_roughness_texture": "red.png"}}})");
  const Shot shot = make_shot(*load_scene({path}));
  const MaterialTextures& textures = shot.textures.at(shot.meshes[0].material);
  EXPECT_EQ(textures.base_color->at({0, 0}, 1).colour, (Vec3f{1, 0, 0}));
  EXPECT_EQ(textures.emission, textures.base_color);
  EXPECT_TRUE(textures.metallic_roughness);
  EXPECT_EQ(shot.meshes[0].uvs[2], (Vec2f{0, 0})) << "OBJ counts v from below";
  ShotOptions without;
  without.textures = false;
  EXPECT_TRUE(make_shot(*load_scene({path}), without).textures.empty());
}

TEST(LoadTextures, MeshesWithoutThePicturesCoordinatesAreNamed) {
  const TempFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  red_png(folder);
  const auto scene = [&](const std::string& set) {
    return load_scene({folder.write("scene.json", R"({"kairos": 1, "meshes": [{"keys": ["a.obj"], "material": "m"},
      {"keys": ["a.obj"], "material": "m"}], "materials": {"m": {"base_color_texture": {"file": "red.png", "uv_set": )" +
                                                      set + "}}}}")});
  };
  EXPECT_THAT(make_shot(*scene("3")).notes,
              testing::Contains(testing::AllOf(HasSubstr("(set 3) for"), HasSubstr("red.png"), HasSubstr("1 other"))));
  ShotOptions strict;
  strict.strict = true;
  expect_error([&] { make_shot(*scene("0"), strict); }, {"no texture coordinates", "red.png"});
}

TEST(LoadTextures, WhatCannotBeReadIsLeftOutWithOneNote) {
  const TempFolder folder;
  GltfBuilder gltf;
  use_image(gltf, {{"uri", "data:image/png,nonsense"}});
  const Scene scene = gltf.parse();
  const Shot shot = make_shot(scene);
  EXPECT_FALSE(shot.textures[0].base_color);
  EXPECT_THAT(shot.notes, testing::Contains(HasSubstr("texture left out: test.gltf: images[0]")).Times(1));
  ShotOptions strict;
  strict.strict = true;
  expect_error([&] { make_shot(scene, strict); }, {"images[0]"});

  Scene missing;
  missing.materials.resize(1);
  missing.materials[0].base_color_texture.picture = folder.path("none.png");
  missing.meshes = scene.meshes;
  for (SceneMesh& mesh : missing.meshes) mesh.material = 0;
  EXPECT_THAT(make_shot(missing).notes, testing::Contains(HasSubstr("none.png")));
  expect_error([&] { make_shot(missing, strict); }, {"none.png"}, ErrorCode::io);
}

}  // namespace
}  // namespace kairos
