// Which files a scene may name: those in its root. What nothing uses need not be there.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <kairos/image.h>
#include <kairos/scene.h>
#include <kairos/scene_files.h>

#include "error_matchers.h"
#include "gltf_builder.h"
#include "scene/scene.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kTexturedTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

/// A folder `scenes` beside a folder `parts` with a picture, a mesh and a piece of pbrt.
class Root : public testing::Test {
 protected:
  Root() {
    Image image{1, 1, 0, 0, 1, 1, {}, {}};
    for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, Channel::Storage::colour, {1}});
    std::filesystem::create_directories(folder_.path("parts"));
    write_image(image, folder_.path("parts/white.png"));
    folder_.write("parts/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder_.write("parts/a.pbrt", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  }

  std::shared_ptr<const Scene> load(const std::string& name, const std::string& text, bool with_root,
                                    bool strict = false) const {
    LoadOptions options;
    options.strict = strict;
    if (with_root) options.root = folder_.path("");
    return load_scene({folder_.write("scenes/" + name, text)}, options);
  }

  /// A scene whose only fault is that a picture lies beside its folder.
  void expect_picture_left_out(const std::string& name, const std::string& text, size_t meshes) const {
    SCOPED_TRACE(name);
    const auto without = load(name, text, false);
    EXPECT_EQ(without->meshes.size(), meshes);
    EXPECT_THAT(without->warnings, Contains(testing::AllOf(HasSubstr("white.png"), HasSubstr("--root"))));
    const auto with = load(name, text, true);
    EXPECT_THAT(with->warnings, IsEmpty());
    const Shot shot = make_shot(*with);
    bool textured = false;
    for (const MaterialTextures& textures : shot.textures) textured = textured || textures.base_color;
    EXPECT_TRUE(textured);
    EXPECT_THAT(files(*with), Contains(HasSubstr("white.png")));
    expect_error([&] { load(name, text, false, true); }, {"white.png", "--root"});
  }

  TempFolder folder_;
};

TEST_F(Root, APictureOutsideIsLeftOut) {
  folder_.write("scenes/t.obj", kTexturedTriangle);
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["images"] = {{{"uri", "../parts/white.png"}}};
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
  expect_picture_left_out("a.gltf", gltf.text(), 1);
  expect_picture_left_out("a.pbrt", R"(Camera "perspective" WorldBegin
      Texture "t" "spectrum" "imagemap" "string filename" "../parts/white.png"
      Material "matte" "texture Kd" "t"
      Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "point2 uv" [0 0 1 0 0 1])",
                          1);
  expect_picture_left_out("a.json", R"({"kairos": 1,
      "meshes": [{"keys": ["t.obj"], "material": "m"}],
      "materials": {"m": {"base_color_texture": "../parts/white.png"}}})",
                          1);
}

TEST_F(Root, WhatSaysWhereThingsAreIsNeeded) {
  const auto expect_needed = [&](const std::string& name, const std::string& text) {
    SCOPED_TRACE(name);
    expect_error([&] { load(name, text, false); }, {"../parts/a", "--root"});
    const auto scene = load(name, text, true);
    EXPECT_EQ(scene->meshes.size(), 1u);
    EXPECT_THAT(files(*scene), ElementsAre(HasSubstr(name), HasSubstr("../parts/a.")));
  };
  expect_needed("include.json", R"({"kairos": 1, "include": ["../parts/a.obj"]})");
  expect_needed("keys.json", R"({"kairos": 1, "meshes": [{"keys": ["../parts/a.obj"]}]})");
  expect_needed("a.pbrt", "WorldBegin\nInclude \"../parts/a.pbrt\"\n");
}

TEST_F(Root, FilesThatAreIncludedReadWhereTheFirstOneMay) {
  folder_.write("scenes/deep/b.json", R"({"kairos": 1, "include": ["../a.obj"]})");
  folder_.write("scenes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(load("a.json", R"({"kairos": 1, "include": ["deep/b.json"]})", false)->meshes.size(), 1u);
  expect_error([&] { load_scene({folder_.path("scenes/deep/b.json")}); }, {"../a.obj", "--root"});
}

TEST_F(Root, FilesOfASceneAreAllThatItsFilesName) {
  folder_.write("scenes/t.obj", std::string("mtllib m.mtl\nusemtl m\n") + kTexturedTriangle);
  folder_.write("scenes/m.mtl", "newmtl m\nmap_Kd ../parts/white.png\n");
  folder_.write("scenes/red.spd", "400 0 700 1\n");
  folder_.write("scenes/t.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                "z\nelement face 1\nproperty list int int vertex_indices\nend_header\n0 0 8 1 0 0 0 1 0 3 0 1 2");
  EXPECT_THAT(files(*load("a.json", R"({"kairos": 1, "include": ["t.obj"]})", true)),
              ElementsAre(HasSubstr("a.json"), HasSubstr("white.png"), HasSubstr("m.mtl"), HasSubstr("t.obj")));
  EXPECT_THAT(files(*load("b.pbrt", R"(WorldBegin Material "matte" "spectrum Kd" "red.spd"
      Shape "plymesh" "string filename" "t.ply")",
                          true)),
              ElementsAre(HasSubstr("b.pbrt"), HasSubstr("red.spd"), HasSubstr("t.ply")));
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root = nlohmann::json::parse(gltf.text());
  folder_.write("scenes/t.bin", std::string(4096, '\0'));
  gltf.root["buffers"][0]["uri"] = "t.bin";
  EXPECT_THAT(files(*load("c.gltf", gltf.root.dump(), true)), ElementsAre(HasSubstr("c.gltf"), HasSubstr("t.bin")));
}

TEST_F(Root, WhatNothingUsesNeedNotBeThere) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root = nlohmann::json::parse(gltf.text());
  gltf.root["buffers"].push_back({{"byteLength", 40}});
  gltf.root["buffers"].push_back({{"byteLength", 40}, {"uri", "absent.bin"}});
  gltf.root["buffers"].push_back({{"byteLength", 40}, {"uri", "../outside.bin"}});
  gltf.root["buffers"].push_back({{"byteLength", 40}, {"uri", "pipe.bin"}});
  gltf.root["images"] = {{{"uri", "../nowhere.png"}}, {{"uri", "data:image/png;base64,?"}}};
  std::filesystem::create_directories(folder_.path("scenes"));
  ASSERT_EQ(mkfifo(folder_.path("scenes/pipe.bin").c_str(), 0600), 0);
  const auto scene = load("unused.gltf", gltf.root.dump(), false, true);
  EXPECT_EQ(scene->meshes.size(), 1u);
  EXPECT_THAT(scene->warnings, IsEmpty());
  const std::vector<std::pair<std::string, ErrorCode>> problems{{"no uri", ErrorCode::bad_input},
                                                                {"absent.bin", ErrorCode::io},
                                                                {"--root", ErrorCode::bad_input},
                                                                {"is no file", ErrorCode::io}};
  for (size_t i = 0; i < problems.size(); ++i) {
    gltf.root["bufferViews"][0]["buffer"] = gltf.root["buffers"].size() - problems.size() + i;
    expect_error([&] { load("used.gltf", gltf.root.dump(), false); }, {problems[i].first}, problems[i].second);
  }
}

TEST_F(Root, PipesAreNoFilesToAnyReader) {
  std::filesystem::create_directories(folder_.path("scenes"));
  for (const char* name : {"p.obj", "p.ply", "p.gltf", "p.json", "p.pbrt", "p.png"})
    ASSERT_EQ(mkfifo(folder_.path(std::string("scenes/") + name).c_str(), 0600), 0);
  for (const char* name : {"p.obj", "p.ply", "p.gltf", "p.json", "p.pbrt"})
    expect_error([&] { load_scene({folder_.path(std::string("scenes/") + name)}); }, {name, "is no file"},
                 ErrorCode::io);
  expect_error([&] { load("a.json", R"({"kairos": 1, "include": ["p.obj"]})", false); }, {"is no file"}, ErrorCode::io);
  expect_error([&] { read_image(folder_.path("scenes/p.png")); }, {"is no file"}, ErrorCode::io);
  folder_.write("scenes/t.obj", kTexturedTriangle);
  const Scene scene = *load("b.json", R"({"kairos": 1, "meshes": [{"keys": ["t.obj"], "material": "m"}],
      "materials": {"m": {"base_color_texture": "p.png"}}})",
                            false);
  EXPECT_THAT(make_shot(scene).notes, Contains(HasSubstr("is no file")));
}

}  // namespace
}  // namespace kairos
