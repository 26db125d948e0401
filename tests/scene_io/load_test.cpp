#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/scene.h>

#include "error_matchers.h"
#include "oracle.h"
#include "scene/scene.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::ElementsAre;

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const char* const kMoved = "v 0 0 4\nv 1 0 4\nv 0 1 4\nf 1 2 3\n";

Vec3d first_vertex(const SceneMesh& mesh, double time) {
  std::vector<Vec3d> out(mesh.motion->vertex_count());
  mesh.motion->positions(time, Side::after, out);
  return out[0];
}

TEST(LoadScene, OneMeshFileIsStatic) {
  const TempFolder folder;
  const auto scene = load_scene({folder.write("one.OBJ", kTriangle)});
  ASSERT_EQ(scene->meshes.size(), 1u);
  EXPECT_EQ(scene->meshes[0].name, "one");
  EXPECT_TRUE(scene->meshes[0].motion->is_static(-1e9, 1e9));
  EXPECT_EQ(scene->materials.size(), 1u);
  EXPECT_FALSE(scene->shutter);
}

TEST(LoadScene, SeveralMeshFilesAreKeysOfOneMesh) {
  const TempFolder folder;
  const std::string a = folder.write("a.obj", kTriangle), b = folder.write("b.obj", kMoved);
  const std::string c =
      folder.write("c.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 8 1 0 0 0 1 0 3 0 1 2");
  const auto scene = load_scene({a, b, c});
  ASSERT_EQ(scene->meshes.size(), 1u);
  EXPECT_EQ(first_vertex(scene->meshes[0], 0.25), (Vec3d{0, 0, 2}));
  EXPECT_EQ(first_vertex(scene->meshes[0], 0.75), (Vec3d{0, 0, 6}));
  EXPECT_EQ(scene->shutter, (std::array<double, 2>{0, 1}));
}

TEST(LoadScene, OtherFilesArePutTogether) {
  const TempFolder folder;
  const std::string a = folder.write("a.obj", kTriangle);
  folder.write("b.obj", kMoved);
  const char* const text =
      R"({"kairos": 1, "meshes": [{"keys": ["a.obj"], "material": "m"}, {"name": "a.1", "keys": ["b.obj"]}],
    "materials": {"m": {"base_color": [1,0,0]}}, "camera": {"keys": [{"eye": [0,0,1], "target": [0,0,0]}]}})";
  std::string other = text;
  for (size_t at = 0; (at = other.find("\"m\"", at)) != other.npos;) other.replace(at, 3, "\"n\"");
  const auto scene = load_scene({folder.write("one.json", text), a, folder.write("two.json", other)});
  std::vector<std::string> meshes, materials, cameras;
  for (const SceneMesh& mesh : scene->meshes) {
    meshes.push_back(mesh.name);
    materials.push_back(scene->materials.at(mesh.material).name);
  }
  for (const SceneCamera& camera : scene->cameras) cameras.push_back(camera.name);
  EXPECT_THAT(meshes, ElementsAre("a", "a.1", "a.2", "a.1.1", "a.3"));
  EXPECT_THAT(materials, ElementsAre("m", "", "n", "", ""));
  EXPECT_THAT(cameras, ElementsAre("camera", "camera.1"));
}

TEST(LoadScene, NativeScenesIncludeGltf) {
  const TempFolder folder;
  folder.write("sub/triangle.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0, "translation": [0, 0, 3]}, {"camera": 0}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  folder.write("a.obj", kTriangle);
  const auto scene = load_scene({folder.write("scene.json", R"({"kairos": 1, "include": ["sub/triangle.gltf"],
    "meshes": [{"keys": ["a.obj"], "material": "m"}], "materials": {"m": {}}})")});
  ASSERT_EQ(scene->meshes.size(), 2u);
  EXPECT_EQ(first_vertex(scene->meshes[0], 0), (Vec3d{0, 0, 3}));
  EXPECT_EQ(scene->materials.at(scene->meshes[1].material).name, "m");
  ASSERT_EQ(scene->cameras.size(), 1u);
  EXPECT_NEAR(scene->cameras[0].vfov, 0.5, 1e-9);
  EXPECT_EQ(scene->fps, 24);  // the included file's
}

TEST(LoadScene, NamesWhatItCannotRead) {
  const TempFolder folder;
  expect_error([] { load_scene({}); }, {"no scene file"}, ErrorCode::bad_usage);
  expect_error([] { load_scene({"scene.fbx"}); }, {"scene.fbx", ".obj, .ply, .gltf, .glb, .pbrt or .json"});
  expect_error([&] { load_scene({folder.path("no.obj")}); }, {"no.obj", "cannot be opened"}, ErrorCode::io);
  expect_error([&] { load_scene({folder.write("x.ply", "solid")}); }, {"x.ply", "is it a PLY file?"});
}

TEST(LoadScene, OracleScenesLoad) {
  const TempFolder folder;
  const uint32_t seed = test::seed();
  test::ask_oracle("moving_triangles.py", folder.path("triangles"), seed, "--triangles 3 --rays 1");
  test::ask_oracle("moving_rectangles.py", folder.path("rectangles"), seed, "--size 2x2 --rectangles 3");
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path(""))) {
    if (entry.path().filename() != "scene.json") continue;
    SCOPED_TRACE(entry.path());
    const auto scene = load_scene({entry.path().string()});
    EXPECT_FALSE(scene->meshes.empty());
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    // The last rectangle is a wall behind the others.
    for (const SceneMesh& mesh : scene->meshes) {
      EXPECT_FALSE(mesh.triangles.empty());
      EXPECT_EQ(mesh.motion->is_static(0, 1), mesh.name == "still" || mesh.name == "rectangle3") << mesh.name;
    }
    ++count;
  }
  EXPECT_EQ(count, 9);
}

}  // namespace
}  // namespace kairos
