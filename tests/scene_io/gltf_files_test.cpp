// Real and malformed glTF files: all load, or are refused with one line.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "data_folders.h"
#include "needed_tools.h"
#include "scene_io/gltf/gltf.h"

namespace kairos {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> gltf_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The scene is what its headers promise, at several times.
void expect_sound(const Scene& scene) {
  ASSERT_FALSE(scene.materials.empty());
  for (const SceneMesh& mesh : scene.meshes) {
    const VertexMotion& motion = *mesh.motion;
    const size_t vertices = motion.vertex_count();
    EXPECT_LT(mesh.material, scene.materials.size());
    EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == vertices);
    EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == vertices);
    for (const auto& set : mesh.more_uvs) EXPECT_TRUE(set.empty() || set.size() == vertices);
    EXPECT_TRUE(mesh.prim_ids.empty() || mesh.prim_ids.size() == mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
      for (uint32_t v : triangle) ASSERT_LT(v, vertices);
    const std::vector<double> kinks = motion.kinks(0, 2);
    for (size_t i = 0; i < kinks.size(); ++i) {
      EXPECT_GT(kinks[i], i == 0 ? 0 : kinks[i - 1]);
      EXPECT_LT(kinks[i], 2);
    }
    std::vector<Vec3d> first(vertices), now(vertices);
    std::vector<Vec3f> normals(vertices);
    motion.positions(0, Side::after, first);
    for (double time : {0.7, 1.3, 2.0}) {
      motion.positions(time, Side::before, now);
      if (motion.is_static(0, 2)) {
        for (size_t v = 0; v < vertices; ++v)
          ASSERT_TRUE(first[v] == now[v] || !is_finite(now[v])) << mesh.name << " claims to rest";
      }
      if (!motion.has_normals()) continue;
      motion.normals(time, Side::after, normals);
      for (const Vec3f& n : normals) ASSERT_NEAR(length(n), 1, 1e-5) << mesh.name;
    }
  }
}

/// What became of the files of a folder.
struct Tally {
  size_t loaded = 0, triangles = 0;
  std::map<std::string, std::string> refused;  // file name -> message
};

Tally tally_of(const fs::path& folder) {
  Tally tally;
  for (const fs::path& file : gltf_files(folder)) {
    SCOPED_TRACE(file.string());
    try {
      LoadContext context;
      const Scene scene = load_gltf(file.string(), context);
      expect_sound(scene);
      ++tally.loaded;
      for (const SceneMesh& mesh : scene.meshes) tally.triangles += mesh.triangles.size();
      for (const std::string& warning : scene.warnings) EXPECT_EQ(warning.find('\n'), std::string::npos);
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_NE(message.find(file.parent_path().string()), std::string::npos) << "does not say where: " << message;
      tally.refused[file.filename().string()] = message;
    }
  }
  return tally;
}

TEST(GltfFiles, EveryThirdPartySceneLoads) {
  if (!fs::exists(scenes_folder())) GTEST_SKIP() << "no third-party scenes at " << scenes_folder();
  const Tally tally = tally_of(scenes_folder());
  EXPECT_TRUE(tally.refused.empty()) << tally.refused.begin()->second;
  EXPECT_GE(tally.loaded, 24u);
  EXPECT_GT(tally.triangles, 1'000'000u);
}

TEST(GltfFiles, MalformedFilesAreRefusedInOneLine) {
  const fs::path folder = "/usr/share/assimp/models/glTF2";
  KAIROS_NEEDS(fs::exists(folder), "the package assimp-testmodels");
  const Tally tally = tally_of(folder);
  EXPECT_GT(tally.loaded, 25u);
  for (const char* name : {"RecursiveNodes.gltf", "sceneWrongType.gltf", "badArray.gltf", "badUint.gltf"})
    EXPECT_TRUE(tally.refused.count(name)) << name;
  for (const auto& [name, message] : tally.refused) fmt::print("refused: {}\n", message);
}

}  // namespace
}  // namespace kairos
