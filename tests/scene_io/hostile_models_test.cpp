// Every model of Debian's assimp-testmodels in a format that is read here, malformed ones included, loads or is refused
// with one line.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/scene.h>

#include "needed_tools.h"
#include "scene/scene.h"

namespace kairos {
namespace {

void evaluate(const SceneMesh& mesh) {
  std::vector<Vec3d> positions(mesh.motion->vertex_count());
  std::vector<Vec3f> normals(mesh.motion->has_normals() ? positions.size() : 0);
  for (const double time : {0.0, 0.7}) {
    mesh.motion->positions(time, Side::after, positions);
    if (!normals.empty()) mesh.motion->normals(time, Side::after, normals);
    for (const Triangle& triangle : mesh.triangles)
      for (const uint32_t v : triangle) ASSERT_LT(v, positions.size()) << mesh.name;
    for (const Vec3f& n : normals) ASSERT_TRUE(is_finite(n)) << mesh.name;
  }
  EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == positions.size());
  EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == positions.size());
  for (const auto& set : mesh.more_uvs) EXPECT_TRUE(set.empty() || set.size() == positions.size());
  EXPECT_TRUE(mesh.prim_ids.empty() || mesh.prim_ids.size() == mesh.triangles.size());
}

void load_all(const std::vector<std::string>& extensions) {
  const std::filesystem::path root = "/usr/share/assimp/models";
  KAIROS_NEEDS(std::filesystem::exists(root), "the package assimp-testmodels");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (std::count(extensions.begin(), extensions.end(), entry.path().extension().string()) > 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  int loaded = 0, refused = 0;
  for (const auto& file : files) {
    SCOPED_TRACE(file);
    try {
      const auto scene = load_scene({file.string()});
      EXPECT_FALSE(scene->materials.empty());
      for (const SceneMesh& mesh : scene->meshes) {
        EXPECT_LT(mesh.material, scene->materials.size());
        evaluate(mesh);
      }
      // Here what is not finite or has no area goes, whatever the format.
      const Shot shot = make_shot(*scene);
      for (const Mesh& mesh : shot.meshes) validate_mesh(mesh);
      for (const std::string& warning : scene->warnings) EXPECT_EQ(warning.find('\n'), warning.npos);
      ++loaded;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), what.npos) << what;
      EXPECT_NE(what.find(file.parent_path().string()), what.npos) << "does not name a file: " << what;
      std::printf("  refused: %s\n", what.c_str());
      ++refused;
    }
  }
  std::printf("%d loaded, %d refused\n", loaded, refused);
  EXPECT_GT(loaded, refused) << "most of these models are sound";
}

TEST(HostileModels, Obj) { load_all({".obj"}); }
TEST(HostileModels, Gltf) { load_all({".gltf", ".glb"}); }
TEST(HostileModels, Ply) { load_all({".ply"}); }

}  // namespace
}  // namespace kairos
