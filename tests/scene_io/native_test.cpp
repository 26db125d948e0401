#include "scene_io/native/native.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Native : public testing::Test {
 protected:
  Native() {
    folder_.write("a0.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("a1.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n");
    folder_.write("two.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\nf 3 2 1\n");
  }

  Scene load(const std::string& text) {
    LoadContext context;
    return load_native(folder_.write("scene.json", text), context);
  }
  void refuse(const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { load(text); }, words);
  }
  /// Same, for the fields of a scene around them.
  void refuse_fields(const std::string& fields, const std::vector<std::string>& words) {
    refuse("{\"kairos\": 1, " + fields + "}", words);
  }

  static Vec3d first_vertex(const SceneMesh& mesh, double time) {
    std::vector<Vec3d> out(mesh.motion->vertex_count());
    mesh.motion->positions(time, Side::after, out);
    return out[0];
  }

  TempFolder folder_;
};

TEST_F(Native, PicturesLieWhereTheyAreTold) {
  const auto read = [&](const std::string& fields) {
    return load(R"({"kairos": 1, "materials": {"m": {)" + fields + "}}}").materials.at(1);
  };
  const Material m = read(R"("normal_texture": {"file": "n.png", "uv_set": 1, "placement": [2, 0, 0.5, 0, 3, 1],
                             "wrap": ["clamp", "mirror"], "nearest": true}, "normal_scale": -0.5, "unlit": true, "specular": 0.25,
                             "specular_color": [1, 0.5, 0], "clearcoat": 0.75, "clearcoat_roughness": 0.125,
                             "one_sided_emission": true, "lamp": true)");
  EXPECT_EQ(m.normal_texture.picture, folder_.path("n.png"));
  EXPECT_EQ(m.normal_texture.uv_set, 1u);
  EXPECT_EQ(m.normal_texture.place({0.5f, 1}), (Vec2f{1.5f, 4}));
  EXPECT_EQ(m.normal_texture.wrap, (std::array{TextureWrap::clamp, TextureWrap::mirror}));
  EXPECT_EQ(m.normal_texture.nearest, true);
  EXPECT_EQ(m.normal_scale, -0.5f);
  EXPECT_TRUE(m.unlit);
  EXPECT_TRUE(m.one_sided_emission);
  EXPECT_TRUE(m.lamp);
  EXPECT_EQ(m.specular, 0.25f);
  EXPECT_EQ(m.specular_color, (Vec3f{1, 0.5f, 0}));
  EXPECT_EQ(m.clearcoat, 0.75f);
  EXPECT_EQ(m.clearcoat_roughness, 0.125f);
  EXPECT_EQ(read(R"("normal_texture": "n.png")").normal_texture.place({0.25f, 2}), (Vec2f{0.25f, 2}));
  refuse_fields(R"("materials": {"m": {"normal_texture": {"uv_set": 1}}})", {"'file' is missing"});
  refuse_fields(R"("materials": {"m": {"normal_texture": {"file": "n.png", "uv_set": 8}}})", {"uv_set", "8"});
  refuse_fields(R"("materials": {"m": {"normal_texture": {"file": "n.png", "wrap": ["clamp", "tile"]}}})",
                {"unknown wrap 'tile'"});
  refuse_fields(R"("materials": {"m": {"normal_texture": {"file": "n.png", "placement": [1]}}})", {"placement"});
}

TEST_F(Native, AlphaMakesMasksAndBlended) {
  using Mode = Material::AlphaMode;
  const auto read = [&](const std::string& fields) {
    return load(R"({"kairos": 1, "materials": {"m": {)" + fields + "}}}").materials.at(1);
  };
  EXPECT_EQ(read("").alpha_mode, Mode::opaque);
  EXPECT_EQ(read("\"alpha\": 0.25").alpha_mode, Mode::blend);
  EXPECT_EQ(read("\"alpha\": 0.25").alpha, 0.25f);
  EXPECT_EQ(read("\"alpha_texture\": \"a.png\"").alpha_mode, Mode::blend);
  EXPECT_EQ(read("\"alpha_texture\": \"a.png\"").alpha_texture.picture, folder_.path("a.png"));
  EXPECT_EQ(read("\"alpha_texture\": \"a.png\", \"alpha_cutoff\": 0.5").alpha_mode, Mode::mask);
  EXPECT_EQ(read("\"alpha_mode\": \"blend\"").alpha_mode, Mode::blend);
  EXPECT_EQ(read("\"alpha_mode\": \"mask\"").alpha_cutoff, 0.5f);
  EXPECT_EQ(read("\"alpha_mode\": \"opaque\", \"alpha\": 0.5").alpha_mode, Mode::opaque);
  refuse_fields(R"("materials": {"m": {"alpha": 1.5}})", {"materials.m.alpha", "1.5"});
  refuse_fields(R"("materials": {"m": {"alpha_mode": "glass"}})", {"materials.m.alpha_mode", "glass", "blend"});
  refuse_fields(R"("materials": {"m": {"alpha_mode": "blend", "alpha_cutoff": 0.5}})", {"alpha_cutoff", "mask"});
}

TEST_F(Native, SurfacesHaveTwoSidesUnlessItSaysOtherwise) {
  const auto read = [&](const std::string& fields) {
    return load(R"({"kairos": 1, "materials": {"m": {)" + fields + "}}}").materials.at(1).double_sided;
  };
  EXPECT_TRUE(read(""));
  EXPECT_TRUE(read("\"double_sided\": true"));
  EXPECT_FALSE(read("\"double_sided\": false"));
  refuse_fields(R"("materials": {"m": {"double_sided": 1}})", {"materials.m.double_sided", "true or false"});
}

TEST_F(Native, ReadsAllOfItsFields) {
  const Scene scene = load(R"({"kairos": 1,
    "meshes": [{"name": "hand", "keys": ["a0.obj", "a1.obj"], "times": [-1, 3], "material": "skin",
                "transform": [{"time": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]},
                              {"time": 1, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1]}]},
               {"keys": ["a1.obj"], "transform": {"matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 0,0,0,1]}}],
    "camera": {"vfov_degrees": 90, "keys": [{"time": 0, "eye": [0,0,5], "target": [0,0,0], "up": [0,1,0]},
                                            {"time": 1, "eye": [1,0,5], "target": [1,0,0]}]},
    "shutter": [0.25, 0.75], "image": {"width": 96, "height": 54},
    "materials": {"other": {}, "skin": {"base_color": [0.5, 0.25, 1], "base_color_texture": "skin.png", "emission": [0, 2, 0],
      "metallic": 0.5, "roughness": 0.25, "transmission": 0.75, "ior": 1.25, "alpha_cutoff": 0.125}},
    "lights": [{"type": "point", "position": [1,2,3], "intensity": [4,5,6]},
               {"type": "directional", "direction": [0,-2,0], "irradiance": [1,1,1]},
               {"type": "constant", "radiance": [0.5,0.5,0.5]},
               {"type": "environment", "texture": "sky.exr", "intensity": 3, "rotation_degrees": 90}],
    "background": [0.125, 0.25, 0.5]})");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "hand");
  EXPECT_EQ(scene.meshes[1].name, "a1");
  EXPECT_EQ(first_vertex(scene.meshes[0], 0), (Vec3d{0, 0, 0.5}));
  EXPECT_EQ(first_vertex(scene.meshes[0], 0.5), (Vec3d{5, 0, 0.75}));
  EXPECT_EQ(first_vertex(scene.meshes[1], 0), (Vec3d{0, 0, 2}));
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.meshes[1].material, 0u);
  const Material& skin = scene.materials.at(scene.meshes[0].material);
  EXPECT_EQ(skin.name, "skin");
  EXPECT_EQ(skin.base_color, (Vec3f{0.5, 0.25, 1}));
  EXPECT_EQ(skin.emission, (Vec3f{0, 2, 0}));
  EXPECT_EQ(skin.metallic, 0.5);
  EXPECT_EQ(skin.roughness, 0.25);
  EXPECT_EQ(skin.transmission, 0.75);
  EXPECT_EQ(skin.ior, 1.25);
  EXPECT_EQ(skin.alpha_cutoff, 0.125);
  EXPECT_EQ(skin.alpha_mode, Material::AlphaMode::mask);
  EXPECT_EQ(skin.base_color_texture.picture, folder_.path("skin.png"));
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_DOUBLE_EQ(scene.cameras[0].vfov, std::numbers::pi / 2);
  EXPECT_EQ(scene.cameras[0].motion->at(0.5, Side::after), translation({0.5, 0, 5}));
  EXPECT_EQ(scene.shutter, (std::array<double, 2>{0.25, 0.75}));
  EXPECT_EQ(scene.image_size, (std::array<int, 2>{96, 54}));
  EXPECT_EQ(scene.background, (Vec3f{0.125, 0.25, 0.5}));
  ASSERT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).intensity, (Vec3f{4, 5, 6}));
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[1]).direction, (Vec3f{0, -1, 0}));
  EXPECT_EQ(std::get<ConstantLight>(scene.lights[2]).radiance, (Vec3f{0.5, 0.5, 0.5}));
  const auto& sky = std::get<EnvironmentLight>(scene.lights[3]);
  EXPECT_EQ(sky.texture, folder_.path("sky.exr"));
  EXPECT_EQ(sky.radiance, (Vec3f{3, 3, 3}));
  EXPECT_EQ(sky.mapping, EnvironmentLight::Mapping::latitude_longitude);
  EXPECT_NEAR(sky.axes[0].z, -1, 1e-9) << "what was right is in front";
  EXPECT_NEAR(sky.axes[2].x, 1, 1e-9);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST_F(Native, MissingTimesAreSpreadEvenly) {
  const Scene scene = load(R"({"kairos": 1, "meshes": [{"name": "m", "keys": ["a0.obj", "a1.obj", "a0.obj"]}],
    "camera": {"keys": [{"eye": [0,0,1], "target": [0,0,0]}, {"eye": [0,0,2], "target": [0,0,0]}]}})");
  EXPECT_EQ(first_vertex(scene.meshes[0], 0.25), (Vec3d{0, 0, 1}));
  EXPECT_EQ(first_vertex(scene.meshes[0], 0.5), (Vec3d{0, 0, 2}));
  EXPECT_EQ(scene.cameras[0].motion->at(0.5, Side::after), translation({0, 0, 1.5}));
  EXPECT_EQ(scene.shutter, (std::array<double, 2>{0, 1}));
  EXPECT_EQ(scene.fps, 1);
  EXPECT_FALSE(load(R"({"kairos": 1, "meshes": [{"keys": ["a0.obj"]}]})").shutter);
}

TEST_F(Native, MirroredMeshesKeepTheirFrontOutside) {
  const std::string mesh = R"({"kairos": 1, "meshes": [{"keys": ["a0.obj"], "transform": {"matrix": [)";
  EXPECT_THAT(load(mesh + "-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]}").meshes[0].triangles,
              ElementsAre(Triangle{0, 2, 1}));
  EXPECT_THAT(load(mesh + "1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]}").meshes[0].triangles,
              ElementsAre(Triangle{0, 1, 2}));
}

TEST_F(Native, TheIncludingFileWins) {
  folder_.write("sub/b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder_.write("sub/inner.json", R"({"kairos": 1, "meshes": [{"name": "m", "keys": ["b.obj"], "material": "red"}],
    "materials": {"red": {"base_color": [1,0,0]}}, "background": [0,0,1], "shutter": [2, 3], "image": {"width": 7, "height": 8},
    "camera": {"keys": [{"eye": [0,0,9], "target": [0,0,0]}]}, "lights": [{"type": "constant", "radiance": [1,1,1]}]})");
  const std::string mesh =
      R"("include": ["sub/inner.json", "a0.obj"], "meshes": [{"name": "m", "keys": ["a0.obj"], "material": "green"}],
    "materials": {"green": {"base_color": [0,1,0]}})";
  const Scene inherited = load("{\"kairos\": 1, " + mesh + "}");
  ASSERT_EQ(inherited.meshes.size(), 3u);
  EXPECT_EQ(inherited.materials.at(inherited.meshes[0].material).name, "red");
  EXPECT_EQ(inherited.materials.at(inherited.meshes[1].material).name, "");
  EXPECT_EQ(inherited.materials.at(inherited.meshes[2].material).name, "green");
  EXPECT_EQ(inherited.background, (Vec3f{0, 0, 1}));
  EXPECT_EQ(inherited.shutter, (std::array<double, 2>{2, 3}));
  EXPECT_EQ(inherited.image_size, (std::array<int, 2>{7, 8}));
  EXPECT_EQ(inherited.cameras.at(0).motion->at(0, Side::after), translation({0, 0, 9}));
  EXPECT_EQ(inherited.lights.size(), 1u);

  const Scene own = load("{\"kairos\": 1, " + mesh +
                         R"(, "background": [0,0,0], "shutter": [0, 1], "image": {"width": 1, "height": 2},
    "camera": {"keys": [{"eye": [0,0,4], "target": [0,0,0]}]}})");
  EXPECT_EQ(own.background, (Vec3f{0, 0, 0}));
  EXPECT_EQ(own.shutter, (std::array<double, 2>{0, 1}));
  EXPECT_EQ(own.image_size, (std::array<int, 2>{1, 2}));
  EXPECT_EQ(own.cameras.at(0).motion->at(0, Side::after), translation({0, 0, 4}));
}

TEST_F(Native, SchemaIsStrict) {
  refuse("[]", {"expected an object"});
  refuse("{}", {"scene.json: the field 'kairos' is missing"});
  refuse(R"({"kairos": 2})", {"kairos", "version 1"});
  refuse("{\"kairos\": 1,\n\"meshes\": [}", {"line 2"});
  refuse(R"({"kairos": 1, "kairos": 1})", {"'kairos' twice"});
  refuse(R"({"kairos": 1e999})", {"number overflow"});
  refuse("{\"kairos\": NaN}", {"line 1"});
  refuse(std::string(100000, '['), {"64 levels"});
  refuse_fields(R"("fps": 24)", {"unknown field 'fps'"});
  refuse_fields(R"("meshes": {})", {"scene.json: meshes: expected an array"});
  refuse_fields(R"("meshes": [{}])", {"scene.json: meshes[0]: the field 'keys' is missing"});
  refuse_fields(R"("meshes": [{"keys": []}])", {"scene.json: meshes[0].keys: a mesh needs at least one key"});
  refuse_fields(R"("meshes": [{"keys": ["a0.obj"], "extra\n": 1}])", {"scene.json: meshes[0]: unknown field 'extra?'"});
  refuse_fields(R"("meshes": [{"keys": ["a0.obj", 3]}])",
                {"scene.json: meshes[0].keys[1]: expected a string, found number"});
  refuse_fields(R"("meshes": [{"keys": ["a0.gltf"]}])",
                {"scene.json: meshes[0].keys[0]: a key must be an OBJ or PLY file"});
  refuse_fields(R"("meshes": [{"keys": ["a0.obj"], "material": "x"}])",
                {"scene.json: meshes[0].material: no material 'x'"});
  refuse_fields(R"("meshes": [{"keys": ["a0.obj", "a1.obj"], "times": [0]}])",
                {"scene.json: meshes[0].times: 1 times for 2 keys"});
  refuse_fields(R"("meshes": [{"keys": ["a0.obj", "a1.obj"], "times": [1, 1]}])",
                {"scene.json: meshes[0].times: times must ascend: 1 is followed by 1"});
  refuse_fields(R"("materials": {"m": {"metallic": 2}})",
                {"scene.json: materials.m.metallic: 2 is not between 0 and 1"});
  refuse_fields(R"("materials": {"m": {"base_color": [1, 1]}})",
                {"scene.json: materials.m.base_color: expected 3 values, found 2"});
  refuse_fields(R"("materials": {"m": {"base_color": [1, -1, 1]}})", {"cannot be negative"});
  refuse_fields(R"("materials": {"m": {"base_color": [1, 1e300, 1]}})", {"materials.m.base_color[1]"});
  refuse_fields(R"("lights": [{"type": "laser"}])", {"scene.json: lights[0].type: unknown light 'laser'"});
  refuse_fields(R"("lights": [{"type": "point", "position": [0,0,0]}])", {"'intensity' is missing"});
  refuse_fields(R"("lights": [{"type": "directional", "direction": [0,0,0], "irradiance": [1,1,1]}])",
                {"direction cannot be zero"});
  refuse_fields(R"("lights": [{"type": "environment"}])", {"'texture' is missing"});
  refuse_fields(R"("lights": [{"type": "environment", "texture": "sky.exr", "intensity": -1}])", {"intensity", "-1"});
  refuse_fields(R"("lights": [1])", {"scene.json: lights[0]: expected an object"});
  refuse_fields(R"("shutter": [1, 0.5])", {"scene.json: shutter: the shutter closes before it opens"});
  refuse_fields(R"("shutter": [1])", {"scene.json: shutter: expected 2 values, found 1"});
  refuse_fields(R"("image": {"width": 0, "height": 2})", {"scene.json: image.width: 0 is not between"});
  refuse_fields(R"("image": {"width": 1.5, "height": 2})", {"scene.json: image.width: 1.5 is not a whole number"});
  refuse_fields(R"("background": [0, true, 0])", {"scene.json: background[1]: expected a number, found boolean"});
}

TEST_F(Native, CamerasAndTransformsAreChecked) {
  const auto camera = [](const std::string& fields) { return R"("camera": {)" + fields + "}"; };
  const std::string key = R"("keys": [{"eye": [0,0,1], "target": [0,0,0]}])";
  for (const char* vfov : {"0", "180", "-1"})
    refuse_fields(camera(R"("vfov_degrees": )" + std::string(vfov) + ", " + key),
                  {"scene.json: camera.vfov_degrees", "is not between"});
  refuse_fields(camera(R"("keys": [])"), {"scene.json: camera.keys: a camera needs at least one key"});
  refuse_fields(camera(R"("keys": [{"eye": [0,0,1], "target": [0,0,1]}])"),
                {"scene.json: camera.keys", "no direction"});
  refuse_fields(
      camera(
          R"("keys": [{"time": 1, "eye": [0,0,1], "target": [0,0,0]}, {"time": 0, "eye": [0,0,1], "target": [0,0,0]}])"),
      {"scene.json: camera.keys: times must ascend"});
  refuse_fields(
      camera(R"("keys": [{"time": 1, "eye": [0,0,1], "target": [0,0,0]}, {"eye": [0,0,1], "target": [0,0,0]}])"),
      {"scene.json: camera.keys[1]: the field 'time' is missing"});
  const auto transform = [](const std::string& value) {
    return R"("meshes": [{"keys": ["a0.obj"], "transform": )" + value + "}]";
  };
  refuse_fields(transform("[]"), {"scene.json: meshes[0].transform: a transform needs at least one matrix"});
  refuse_fields(transform("3"), {"scene.json: meshes[0].transform: expected an array"});
  refuse_fields(transform(R"({"matrix": [1,0,0]})"),
                {"scene.json: meshes[0].transform.matrix: expected 16 values, found 3"});
  refuse_fields(transform(R"([{"matrix": [1,0,0,5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])"),
                {"scene.json: meshes[0].transform[0].matrix: its last row"});
  refuse_fields(transform(R"([{"matrix": [1e99,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])"), {"transform[0].matrix[0]"});
}

TEST_F(Native, FilesAreConfinedAndCounted) {
  refuse_fields(R"("include": ["/etc/passwd"])", {"scene.json: include[0]", "leaves the folder"});
  refuse_fields(R"("include": ["../x.obj"])", {"scene.json: include[0]", "leaves the folder"});
  refuse_fields(R"("include": ["a\u0000.obj"])", {"scene.json: include[0]", "control character"});
  refuse_fields(R"("include": ["x.txt"])", {"extension"});
  refuse_fields(R"("include": ["scene.json"])", {"includes itself"});
  folder_.write("b.json", R"({"kairos": 1, "include": ["scene.json"]})");
  refuse_fields(R"("include": ["b.json"])", {"includes itself"});
  expect_error([&] { load(R"({"kairos": 1, "include": ["missing.obj"]})"); }, {"missing.obj", "cannot be opened"},
               ErrorCode::io);
  refuse_fields(R"("meshes": [{"keys": ["a0.obj", "two.obj"]}])", {"two.obj: has 2 faces", "a0.obj has 1"});
}

TEST_F(Native, DeepAndWideIncludesEnd) {
  for (int i = 0; i < 20; ++i)
    folder_.write(std::to_string(i) + ".json",
                  "{\"kairos\": 1, \"include\": [\"" + std::to_string(i + 1) + ".json\"]}");
  expect_error([&] { load(R"({"kairos": 1, "include": ["0.json"]})"); }, {"nested more than 16 deep"});
  // Each file includes the next one twice: 2^15 files from 15.
  for (int i = 0; i < 14; ++i) {
    const std::string next = "\"" + std::to_string(i + 1) + ".json\"";
    folder_.write(std::to_string(i) + ".json", "{\"kairos\": 1, \"include\": [" + next + ", " + next + "]}");
  }
  folder_.write("14.json", R"({"kairos": 1})");
  LoadContext context;
  context.files_left = 100;
  expect_error([&] { load_native(folder_.path("0.json"), context); }, {"too many files"});
}

TEST_F(Native, StrictRefusesBadTriangles) {
  folder_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n");
  const std::string path = folder_.write("scene.json", R"({"kairos": 1, "meshes": [{"keys": ["bad.obj"]}]})");
  LoadContext context;
  EXPECT_THAT(load_native(path, context).warnings, ElementsAre(testing::HasSubstr("1 of 2 triangles dropped")));
  context.options.strict = true;
  expect_error([&] { load_native(path, context); }, {"bad.obj", "1 of 2 triangles dropped"});
}

}  // namespace
}  // namespace kairos
