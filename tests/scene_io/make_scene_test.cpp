// Scenes from memory: the same as from files, and what is refused.
#include <cmath>
#include <cstring>
#include <numeric>

#include <gtest/gtest.h>

#include <kairos/files.h>
#include <kairos/make_scene.h>
#include <kairos/render.h>

#include "error_matchers.h"
#include "image/encode.h"
#include "temp_folder.h"

namespace kairos {
namespace {

/// A card that slides and is turned by its placement, and one at rest with a picture on it.
SceneDescription cards() {
  SceneDescription scene;
  MeshDescription card;
  card.name = "card";
  card.triangles = {{0, 1, 2}, {0, 2, 3}};
  card.times = {-1, 3};
  card.positions = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                    {{0, -1, 0}, {2, -1, 0}, {2, 1, 0.5f}, {0, 1, 0}}};
  card.normals = {{{0, 0, 2}, {0, 0, 1}, {0, 1, 1}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 1}}};
  card.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  card.material = 1;
  scene.meshes = {card};
  InstanceDescription turned;
  turned.placement = {{0, {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, -1, 1}}}},
                      {1, {{{0, 1, 0, 0}, {-1, 0, 0, 0}, {0, 0, 1, 0}, {0.5, 0, -1, 1}}}}};
  InstanceDescription mirrored;
  mirrored.name = "mirrored";
  mirrored.material = 2;
  mirrored.placement = {{0, {{{-0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 0.5, 0}, {-1, 1, -3, 1}}}}};
  scene.instances = {turned, mirrored};
  scene.materials.resize(3);
  scene.materials[1].name = "red";
  scene.materials[1].base_color = {1, 0.25f, 0.25f};
  scene.materials[2].name = "painted";
  scene.materials[2].base_color_texture.picture = "squares";
  scene.pictures["squares"] = {2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 10, 20, 30, 255, 200, 100, 50, 255}, {}};
  CameraDescription camera;
  camera.vfov = 1;
  camera.keys = {{0, {0, 0, 5}, {0, 0, 0}, {0, 1, 0}}, {1, {0.5, 0, 5}, {0, 0, 0}, {0, 1, 0}}};
  camera.shift = {0.125, -0.25};
  camera.pixel_aspect = 1.5;
  scene.cameras = {camera};
  scene.lights = {DirectionalLight{{0, -1, -2}, {1, 1, 1}}, PointLight{{1, 2, 3}, {4, 5, 6}}};
  scene.background = {0.125f, 0.25f, 0.5f};
  scene.shutter = {0.25, 0.75};
  scene.image_size = {32, 24};
  return scene;
}

void write_cards(const TempFolder& folder) {
  const std::string corners = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", faces = "f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\n";
  folder.write("a.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0 0 2\nvn 0 0 1\nvn 0 1 1\nvn 0 0 1\n" + corners + faces);
  folder.write("b.obj",
               "v 0 -1 0\nv 2 -1 0\nv 2 1 0.5\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 1 0 1\n" + corners + faces);
  const std::vector<uint8_t> codes{255, 0, 0, 0, 255, 0, 10, 20, 30, 200, 100, 50};
  const std::vector<uint8_t> png = encode_png(codes, 2, 2, 3, "squares");
  write_file(folder.path("squares.png"), {reinterpret_cast<const char*>(png.data()), png.size()});
  folder.write("scene.json", R"({"kairos": 1, "meshes": [
    {"name": "card", "keys": ["a.obj", "b.obj"], "times": [-1, 3], "material": "red",
     "transform": [{"time": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,-1,1]},
                   {"time": 1, "matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 0.5,0,-1,1]}]},
    {"name": "mirrored", "keys": ["a.obj", "b.obj"], "times": [-1, 3], "material": "painted",
     "transform": {"matrix": [-0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, -1,1,-3,1]}}],
    "materials": {"red": {"base_color": [1, 0.25, 0.25]}, "painted": {"base_color_texture": "squares.png"}},
    "camera": {"vfov_degrees": 57.29577951308232, "shift": [0.125, -0.25], "pixel_aspect": 1.5,
               "keys": [{"time": 0, "eye": [0,0,5], "target": [0,0,0]}, {"time": 1, "eye": [0.5,0,5], "target": [0,0,0]}]},
    "lights": [{"type": "directional", "direction": [0,-1,-2], "irradiance": [1,1,1]},
               {"type": "point", "position": [1,2,3], "intensity": [4,5,6]}],
    "background": [0.125, 0.25, 0.5], "shutter": [0.25, 0.75], "image": {"width": 32, "height": 24}})");
}

bool same_bits(const Image& a, const Image& b) {
  if (a.channels.size() != b.channels.size() || a.width != b.width || a.height != b.height) return false;
  for (size_t c = 0; c < a.channels.size(); ++c)
    if (std::memcmp(a.channels[c].values.data(), b.channels[c].values.data(),
                    a.channels[c].values.size() * sizeof(float)))
      return false;
  return true;
}

TEST(MakeScene, RendersTheBitsOfTheSameSceneFromFiles) {
  const TempFolder folder;
  write_cards(folder);
  const Shot from_file = make_shot(*load_scene({folder.path("scene.json")}));
  SceneDescription description = cards();
  description.cameras[0].vfov = from_file.projection.vfov;  // through degrees
  const Shot from_memory = make_shot(*make_scene(description));
  ASSERT_EQ(from_memory.meshes.size(), 2u);
  EXPECT_EQ(from_memory.meshes[0].key_count(), from_file.meshes[0].key_count());
  EXPECT_GE(from_memory.meshes[0].key_count(), 2u);
  EXPECT_NE(from_memory.textures[2].base_color, nullptr);
  for (const IntegratorKind integrator : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::automatic})
    for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::flat, ShadingKind::whitted}) {
      RenderParams params;
      params.integrator = integrator;
      params.shading = shading;
      params.tc_rays = 4;
      params.spp = 8;
      params.aovs = {Aov::depth, Aov::coverage};
      const Image a = render(from_file, params), b = render(from_memory, params);
      EXPECT_TRUE(same_bits(a, b)) << int(integrator) << ' ' << int(shading);
      EXPECT_EQ(b.pixel_aspect, 1.5);
      const std::vector<float>& coverage = b.find("coverage.A")->values;
      EXPECT_GT(std::accumulate(coverage.begin(), coverage.end(), 0.0f), 20);
    }
}

TEST(MakeScene, SaysWhatItHolds) {
  const SceneContents held = contents(*make_scene(cards()));
  ASSERT_EQ(held.meshes.size(), 2u);
  EXPECT_EQ(held.meshes[0].name, "card");
  EXPECT_EQ(held.meshes[1].name, "mirrored");
  EXPECT_EQ(held.meshes[1].triangles, 2u);
  EXPECT_EQ(held.meshes[1].vertices, 4u);
  EXPECT_EQ(held.meshes[1].material, 2u);
  ASSERT_EQ(held.cameras.size(), 1u);
  EXPECT_EQ(held.cameras[0].name, "camera");
  EXPECT_EQ(held.cameras[0].shift[1], -0.25);
  EXPECT_EQ(held.materials[1].name, "red");
  EXPECT_EQ(held.lights.size(), 2u);
  EXPECT_EQ(held.pictures, std::vector<std::string>{"squares"});
  EXPECT_EQ(held.shutter, (std::array<double, 2>{0.25, 0.75}));
  EXPECT_EQ(held.image_size, (std::array<int, 2>{32, 24}));
  EXPECT_TRUE(held.warnings.empty());
}

// A view whose film is the square from -1 to 1, said twice.
TEST(MakeScene, AProjectionMatrixIsALens) {
  SceneDescription scene = cards();
  scene.cameras[0] = CameraDescription();
  scene.cameras[0].keys = {camera_key(0, {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.25, 0, 5, 1}}})};
  scene.cameras[0].orthographic = true;
  scene.cameras[0].view_height = 4;
  scene.image_size = {16, 16};
  const Shot lens = make_shot(*make_scene(scene));
  scene.cameras[0].orthographic = false;
  scene.cameras[0].matrix = Matrix{{{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, -0.01, 0}, {0, 0, 0, 1}}};
  const Shot matrix = make_shot(*make_scene(scene));
  for (const IntegratorKind integrator : {IntegratorKind::tc, IntegratorKind::automatic}) {
    RenderParams params;
    params.integrator = integrator;
    params.tc_rays = 2;
    params.spp = 4;
    params.shading = ShadingKind::whitted;
    EXPECT_TRUE(same_bits(render(lens, params), render(matrix, params))) << int(integrator);
  }
}

TEST(MakeScene, ADescriptionOfNothingIsAnEmptyScene) {
  const Shot shot = make_shot(*make_scene({}));
  EXPECT_TRUE(shot.meshes.empty());
  EXPECT_EQ(shot.materials.size(), 1u);
  EXPECT_EQ(shot.projection.width, 960);
}

TEST(MakeScene, RefusesWhatCannotBeUsed) {
  const auto refused = [](const auto& change, const std::vector<std::string>& words) {
    SceneDescription scene = cards();
    change(scene);
    expect_error([&] { make_scene(std::move(scene)); }, words);
  };
  const float nan = NAN;
  using S = SceneDescription;
  refused([](S& s) { s.meshes[0].triangles[1][2] = 4000000000u; }, {"mesh 0 'card'", "triangle 1", "4000000000 of 4"});
  refused([&](S& s) { s.meshes[0].positions[1][2].y = nan; }, {"mesh 0 'card'", "key 1", "2", "not finite"});
  refused([](S& s) { s.meshes[0].positions[1].pop_back(); }, {"mesh 0", "key 1", "3 positions", "4 vertices"});
  refused([](S& s) { s.meshes[0].positions.clear(); }, {"mesh 0", "no key"});
  refused([](S& s) { s.meshes[0].times = {1, 1}; }, {"mesh 0", "ascend"});
  refused([](S& s) { s.meshes[0].times = {}; }, {"mesh 0", "2 keys and 0 times"});
  refused([&](S& s) { s.meshes[0].times = {0, NAN}; }, {"mesh 0", "time that is not finite"});
  refused([](S& s) { s.meshes[0].normals.pop_back(); }, {"mesh 0", "normals at 1 of its 2 keys"});
  refused([](S& s) { s.meshes[0].normals[1][3] = {}; }, {"mesh 0", "normal of vertex 3 is zero"});
  refused([](S& s) { s.meshes[0].uvs.pop_back(); }, {"mesh 0", "3 texture coordinates"});
  refused([](S& s) { s.meshes[0].more_uvs = {{}, {{0, 0}}}; }, {"mesh 0", "1 texture coordinates"});
  refused([](S& s) { s.meshes[0].colors.resize(3); }, {"mesh 0", "3 colours for 4 vertices"});
  refused([](S& s) { s.meshes[0].colors = {{}, {}, {0, 0, 0, -1}, {}}; }, {"mesh 0", "colour of vertex 2"});
  refused([](S& s) { s.materials[1].clearcoat = 2; }, {"material 1", "clearcoat 2"});
  refused([](S& s) { s.materials[1].specular_color.x = -1; }, {"material 1", "specular colour"});
  refused([](S& s) { s.materials[1].normal_scale = NAN; }, {"material 1", "normal picture"});
  refused([](S& s) { s.materials[1].alpha_texture.placement[0].x = NAN; }, {"material 1", "placement"});
  refused([](S& s) { s.meshes[0].material = 3; }, {"mesh 0", "material 3"});
  refused([](S& s) { s.instances[1].material = 9; }, {"instance 1 'mirrored'", "material 9"});
  refused([](S& s) { s.instances[0].mesh = 1; }, {"instance 0", "mesh 1"});
  refused([](S& s) { s.instances[0].placement[1].matrix[3][3] = 2; }, {"instance 0", "key 1", "last row"});
  refused([&](S& s) { s.instances[0].placement[1].matrix[0][1] = NAN; }, {"instance 0", "key 1", "not finite"});
  refused([](S& s) { s.instances[0].placement[1].time = 0; }, {"instance 0", "ascend"});
  refused([&](S& s) { s.materials[1].base_color.y = nan; }, {"material 1 'red'", "base colour"});
  refused([](S& s) { s.materials[1].emission.y = -1; }, {"material 1 'red'", "emission"});
  refused([](S& s) { s.materials[1].ior = 0.5f; }, {"material 1", "ior 0.5"});
  refused([](S& s) { s.pictures["squares"].codes.pop_back(); }, {"picture 'squares'", "15 codes", "16"});
  refused([](S& s) { s.pictures["squares"].width = 1 << 30; }, {"picture 'squares'", "1073741824x2"});
  refused([](S& s) { s.pictures["a"] = {1, 1, {}, {0, 0, INFINITY, 1}}; }, {"picture 'a'", "not finite"});
  refused([](S& s) { s.cameras[0].vfov = 0; }, {"camera 0 'camera'", "field of view"});
  refused([](S& s) { s.cameras[0].keys.clear(); }, {"camera 0", "no key"});
  refused([&](S& s) { s.cameras[0].keys[1].eye.x = NAN; }, {"camera 0", "key 1", "not finite"});
  refused([](S& s) { s.cameras[0].keys[1].target = s.cameras[0].keys[1].eye; }, {"camera 0", "no direction"});
  refused([](S& s) { s.lights[0] = DirectionalLight{{}, {1, 1, 1}}; }, {"light 0", "direction"});
  refused([](S& s) { s.lights[1] = PointLight{{}, {1, -1, 1}}; }, {"light 1", "intensity"});
  refused([](S& s) { s.lights[1] = SpotLight{{}, {0, 0, 1}, {1, 1, 1}, 0.5f, 0.75f}; }, {"light 1", "cosines"});
  refused([](S& s) { s.lights[1] = EnvironmentLight{"", {1, 1, 1}, {}, {}}; }, {"light 1", "axes"});
  refused([&](S& s) { s.background.x = nan; }, {"background"});
  refused([](S& s) { s.shutter = {1, 0}; }, {"shutter"});
  refused([](S& s) { s.fps = 0; }, {"0 frames"});
}

}  // namespace
}  // namespace kairos
