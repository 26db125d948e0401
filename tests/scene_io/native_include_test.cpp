// Files that a native scene puts together, each at a place and with an animation of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"
#include "gltf_builder.h"
#include "scene_io/load.h"
#include "scene_io/native/native.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class NativeInclude : public testing::Test {
 protected:
  NativeInclude() {
    folder_.write("a0.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("a1.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n");
  }

  Scene load(const std::string& text) {
    LoadContext context;
    return load_native(folder_.write("scene.json", text), context);
  }
  /// A scene with these fields is refused.
  void refuse_fields(const std::string& fields, const std::vector<std::string>& words) {
    expect_error([&] { load("{\"kairos\": 1, " + fields + "}"); }, words);
  }

  static Vec3d first_vertex(const SceneMesh& mesh, double time) {
    std::vector<Vec3d> out(mesh.motion->vertex_count());
    mesh.motion->positions(time, Side::after, out);
    return out[0];
  }

  TempFolder folder_;
};

TEST_F(NativeInclude, AnIncludedFileIsPlaced) {
  // In the file: from z = 0 to 2 in [0, 1], then still. Its place: x from 0 to 10 in [0.5, 2.5].
  folder_.write("inner.json", R"({"kairos": 1, "meshes": [{"keys": ["a0.obj", "a1.obj"]}],
    "camera": {"keys": [{"eye": [0,0,9], "target": [0,0,0]}]}, "lights": [{"type": "constant", "radiance": [1,1,1]}]})");
  const std::string at = R"([{"time": 0.5, "matrix": [SIGN,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]},
    {"time": 2.5, "matrix": [SIGN,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1]}])";
  const auto placed = [&](const std::string& sign) {
    std::string transform = at;
    for (size_t found; (found = transform.find("SIGN")) != transform.npos;) transform.replace(found, 4, sign);
    return load(R"({"kairos": 1, "include": [{"file": "inner.json", "transform": )" + transform + "}]}");
  };
  const Scene scene = placed("1");
  ASSERT_EQ(scene.meshes.size(), 1u);
  const VertexMotion& motion = *scene.meshes[0].motion;
  EXPECT_EQ(first_vertex(scene.meshes[0], 0.25), (Vec3d{0, 0, 0.5}));
  EXPECT_EQ(first_vertex(scene.meshes[0], 1.5), (Vec3d{5, 0, 2}));
  EXPECT_EQ(first_vertex(scene.meshes[0], 9), (Vec3d{10, 0, 2}));
  EXPECT_THAT(motion.kinks(-1, 5), ElementsAre(0, 0.5, 1, 2.5));
  EXPECT_THAT(motion.kinks(0.5, 1), IsEmpty());
  EXPECT_FALSE(motion.is_static(0, 0.5));
  EXPECT_FALSE(motion.is_static(1, 2));
  EXPECT_TRUE(motion.is_static(3, 4));
  EXPECT_FALSE(motion.is_linear_between_kinks());
  EXPECT_TRUE(scene.cameras.empty());
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.meshes[0].triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(placed("-1").meshes[0].triangles[0], (Triangle{0, 2, 1}));

  refuse_fields(R"("include": [{"transform": {"matrix": []}}])",
                {"scene.json: include[0]: the field 'file' is missing"});
  refuse_fields(R"("include": [{"file": "../x.obj"}])", {"scene.json: include[0].file", "leaves the folder"});
  refuse_fields(R"("include": [{"file": "a0.obj", "time": 0}])", {"scene.json: include[0]", "unknown field 'time'"});
  refuse_fields(R"("include": [{"file": "a0.obj", "transform": []}])", {"include[0].transform", "at least one matrix"});
}

TEST_F(NativeInclude, NormalsOfAPlacedFileTurnWithIt) {
  folder_.write("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nf 1//1 2//1 3//1\n");
  // Twice as wide in x, so half as much of a normal; mirrored in z.
  const Scene scene = load(R"({"kairos": 1, "include": [{"file": "n.obj", "transform":
    {"matrix": [2,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]}}]})");
  std::vector<Vec3f> normals(3);
  scene.meshes[0].motion->normals(0, Side::after, normals);
  EXPECT_NEAR(length(to_double(normals[0])), 1, 1e-6);
  EXPECT_NEAR(normals[0].x / normals[0].z, -0.3 / 0.8, 1e-6);
  EXPECT_GT(normals[0].x, 0);
}

TEST_F(NativeInclude, EachIncludedFilePlaysItsOwnAnimation) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  gltf.root["animations"][0]["name"] = "along";
  const nlohmann::json along = gltf.root["animations"][0];
  gltf.root.erase("animations");
  gltf.animate(node, "translation", {0, 1}, {0, 0, 0, 0, 1, 0}, "VEC3");
  gltf.root["animations"][0]["name"] = "up";
  gltf.push("animations", along);
  folder_.write("g.gltf", gltf.text());
  const Scene scene = load(R"({"kairos": 1, "include": [{"file": "g.gltf", "animation": "along"}, "g.gltf"]})");
  EXPECT_EQ(first_vertex(scene.meshes.at(0), 1), (Vec3d{1, 0, 0}));
  EXPECT_EQ(first_vertex(scene.meshes.at(1), 1), (Vec3d{0, 1, 0}));
  refuse_fields(R"("include": [{"file": "g.gltf", "animation": "down"}])", {"include[0].animation", "down", "'up'"});
}

}  // namespace
}  // namespace kairos
