// Small files that would grow without end: one budget for all that they may become.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/scene.h>

#include "error_matchers.h"
#include "gltf_builder.h"
#include "gzip_text.h"
#include "picture_files.h"
#include "scene/scene.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr uint64_t kSmall = 1 << 20;

LoadOptions with_budget(uint64_t bytes) {
  LoadOptions options;
  options.memory_budget = bytes;
  return options;
}

/// One triangle of a mesh that says it has many vertices, all of them zero.
std::string sparse_gltf(int vertices) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["accessors"][0].erase("bufferView");
  gltf.root["accessors"][0]["count"] = vertices;
  return gltf.text();
}

TEST(Budget, IsOneForAllThatAreIncluded) {
  const TempFolder folder;
  folder.write("fat.gltf", sparse_gltf(50000));  // 0.6 MB of positions
  std::string list;
  for (int i = 0; i < 20; ++i) list += (i ? ", \"fat.gltf\"" : "\"fat.gltf\"");
  const std::string path = folder.write("all.json", R"({"kairos": 1, "include": [)" + list + "]}");
  expect_error([&] { load_scene({path}, with_budget(kSmall)); }, {"fat.gltf", "--memory-budget"});
  EXPECT_EQ(load_scene({path}, with_budget(100 * kSmall))->meshes.size(), 20u);
  expect_error([&] { load_scene(std::vector(20, folder.path("fat.gltf")), with_budget(kSmall)); }, {"--memory-budget"});
}

TEST(Budget, BoundsMotionKeys) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.triangle_node({0, 0, 0, 1, 0, 0, 0, 1, 0});
  gltf.root["accessors"][0].erase("bufferView");
  constexpr size_t kVertices = 3000;
  gltf.root["accessors"][0]["count"] = kVertices;
  std::vector<float> times, turns;
  for (int i = 0; i < 64; ++i) {  // 32 turns a second about z, in quarter turns
    times.push_back(static_cast<float>(i) / 128);
    const float angle = static_cast<float>(i) * 0.785398f;
    turns.insert(turns.end(), {0, 0, std::sin(angle), std::cos(angle)});
  }
  gltf.animate(0, "rotation", times, turns, "VEC4");
  gltf.root["nodes"][0]["translation"] = {0, 0, 0};
  // The corner that is seen lies off the axis.
  gltf.root["accessors"][0]["sparse"] = {
      {"count", 3},
      {"indices", {{"bufferView", gltf.view(std::vector<uint32_t>{0, 1, 2})}, {"componentType", 5125}}},
      {"values", {{"bufferView", gltf.view(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})}}}};
  const std::string path = folder.write("spin.gltf", gltf.text());
  const auto bytes_with = [&](uint64_t budget) {
    const Shot shot = make_shot(*load_scene({path}, with_budget(budget)));
    uint64_t bytes = 0;
    for (const Mesh& mesh : shot.meshes)
      for (const auto& key : mesh.positions) bytes += key.size() * sizeof(Vec3f);
    return bytes;
  };
  const uint64_t file = std::filesystem::file_size(path) * 1024;
  const uint64_t wanted = bytes_with(uint64_t{1} << 30);
  ASSERT_GT(wanted, 1000000u) << "many keys are worth it";
  Scene scene = *load_scene({path}, with_budget(uint64_t{1} << 30));
  ASSERT_GT(file, kSmall);
  constexpr uint64_t kLittle = 600000;  // more than the corners of the path take
  for (const uint64_t budget : {wanted, kLittle}) {
    scene.memory_budget = budget;
    const Shot shot = make_shot(scene);
    uint64_t bytes = 0;
    for (const Mesh& mesh : shot.meshes)
      for (const auto& key : mesh.positions) bytes += key.size() * sizeof(Vec3f);
    EXPECT_LE(bytes, budget / 2);
    EXPECT_THAT(shot.notes, Contains(HasSubstr("motion keys"))) << "said, since the motion is coarser than wished";
  }
}

TEST(Budget, BoundsUnpacking) {
  const TempFolder folder;
  const std::string zeros = test::gzipped("WorldBegin\n" + std::string(50 << 20, ' '));
  ASSERT_LT(zeros.size(), 100000u);
  folder.write("zeros.pbrt.gz", zeros);
  const std::string path = folder.write("a.pbrt", "Include \"zeros.pbrt.gz\"\n");
  expect_error([&] { load_scene({path}, with_budget(kSmall)); }, {"zeros.pbrt.gz", "--memory-budget"});
  load_scene({path}, with_budget(400 * kSmall));
}

TEST(Budget, BoundsSubdivisionAndInstances) {
  const TempFolder folder;
  const std::string cage = "\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";
  const std::string loop = folder.write("a.pbrt", "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 8 " + cage);
  expect_error([&] { load_scene({loop}, with_budget(kSmall)); }, {"a.pbrt:2", "--memory-budget"});
  EXPECT_EQ(load_scene({loop}, with_budget(100 * kSmall))->meshes.size(), 1u);
  std::string many = "WorldBegin\nObjectBegin \"o\"\nShape \"trianglemesh\" " + cage + "ObjectEnd\n";
  for (int level = 0; level < 4; ++level) {
    many += "ObjectBegin \"o" + std::to_string(level) + "\"\n";
    for (int i = 0; i < 16; ++i) many += "ObjectInstance \"o" + (level ? std::to_string(level - 1) : "") + "\"\n";
    many += "ObjectEnd\n";
  }
  const std::string instances = folder.write("b.pbrt", many + "ObjectInstance \"o3\"\n");
  expect_error([&] { load_scene({instances}, with_budget(kSmall)); }, {"b.pbrt", "--memory-budget"});
}

TEST(Budget, IsSharedByPictures) {
  const TempFolder folder;
  const auto write = [&](const std::string& name, const Bytes& bytes) {
    folder.write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
  const Bytes flat = png_file(1024, 1024, 8, 0, Bytes(1025 * 1024, 0));  // 5.6 MB with its coarser copies
  write("a.png", flat);
  write("b.png", flat);
  write("scans.jpg", jpeg_of_claimed_size(progressive_jpeg(100), 8192, 8192));
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  folder.write("t.obj", triangle);
  const std::string path = folder.write("s.json", R"({"kairos": 1, "meshes": [{"keys": ["t.obj"], "material": "a"},
      {"keys": ["t.obj"], "material": "b"}, {"keys": ["t.obj"], "material": "c"}], "materials": {
      "a": {"base_color_texture": "a.png"}, "b": {"base_color_texture": "b.png"}, "c": {"base_color_texture": "scans.jpg"}}})");
  const auto textures_with = [&](uint64_t budget, std::vector<std::string>& notes) {
    const Shot shot = make_shot(*load_scene({path}, with_budget(budget)));
    notes = shot.notes;
    size_t count = 0;
    for (const MaterialTextures& textures : shot.textures) count += textures.base_color ? 1 : 0;
    return count;
  };
  std::vector<std::string> notes;
  EXPECT_EQ(textures_with(uint64_t{1} << 28, notes), 2u) << "but not the one of many scans";
  EXPECT_THAT(notes, Contains(testing::AllOf(HasSubstr("scans.jpg"), HasSubstr("--memory-budget"))));
  // Their own bytes grant something, too.
  const uint64_t granted = 1024 * (2 * flat.size() + 3 * triangle.size() + std::filesystem::file_size(path) +
                                   std::filesystem::file_size(folder.path("scans.jpg")));
  ASSERT_LT(granted, uint64_t{11} << 20) << "less than both take";
  EXPECT_EQ(textures_with((uint64_t{6} << 20) - std::min(granted, uint64_t{6} << 20), notes), 1u);
}

}  // namespace
}  // namespace kairos
