// tools/kitchen_scene.py: what pbrt would show, shown the same way round.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <kairos/scene.h>

#include "data_folders.h"
#include "scene/scene.h"
#include "temp_folder.h"

namespace kairos {
namespace {

void convert(const std::string& from, const std::string& to) {
  const std::string command =
      fmt::format("python3 '{}/tools/kitchen_scene.py' '{}' '{}' > /dev/null", KAIROS_SOURCE_DIR, from, to);
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// The first vertex of the first mesh as the camera sees it when the shutter opens.
Vec3d in_camera(const Scene& scene) {
  std::vector<Vec3d> positions(scene.meshes.at(0).motion->vertex_count());
  scene.meshes[0].motion->positions(0, Side::after, positions);
  return transform_point(inverse_affine(scene.cameras.at(0).motion->at(0, Side::after)), positions.at(0));
}

/// pbrt's camera space has x to the right, y up and z forward. A vertex that pbrt sees at (1, 0.5, 4) must be at
/// (1, 0.5, -4) for us, in left-handed worlds (pbrt's own kind) and in right-handed ones.
TEST(KitchenScene, IsNotMirrored) {
  for (const bool right_handed : {false, true}) {
    const TempFolder folder;
    folder.write("models/m.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list int int vertex_indices\nend_header\n1 0.5 4 0 0 4 0 1 4 3 0 1 2\n");
    // Camera from world: the mirror, a turn by 30 degrees about y, then 5 forward. The mesh is given in camera space
    // and placed by the inverse.
    const std::string mirror = right_handed ? "Scale -1 1 1\n" : "";
    folder.write("scene.pbrt",
                 "Translate 0 0 5\nRotate 30 0 1 0\n" + mirror +
                     "Camera \"perspective\" \"float fov\" [ 40 ]\n"
                     "Film \"image\" \"integer xresolution\" [ 320 ] \"integer yresolution\" [ 640 ]\n"
                     "WorldBegin # comment\nMakeNamedMaterial \"red\" \"string type\" [ \"matte\" ] "
                     "\"rgb Kd\" [ 1 0 0 ]\nAttributeBegin\nNamedMaterial \"red\"\n" +
                     mirror +
                     "Rotate -30 0 1 0\nTranslate 0 0 -5\n"
                     "Shape \"plymesh\" \"string filename\" [ \"models/m.ply\" ]\nAttributeEnd\nWorldEnd\n");
    convert(folder.path("."), folder.path("out"));
    const auto scene = load_scene({folder.path("out/scene.json")});
    const Vec3d seen = in_camera(*scene);
    EXPECT_NEAR(seen.x, 1, 1e-9) << right_handed;
    EXPECT_NEAR(seen.y, 0.5, 1e-9) << right_handed;
    EXPECT_NEAR(seen.z, -4, 1e-9) << right_handed;
    EXPECT_EQ(scene->materials.at(scene->meshes[0].material).base_color, (Vec3f{1, 0, 0}));
    // The picture is twice as high as wide: 40 degrees are its width's.
    EXPECT_NEAR(std::tan(scene->cameras[0].vfov / 2), 2 * std::tan(std::numbers::pi / 9), 1e-9);
    EXPECT_FALSE(scene->cameras[0].motion->is_static(0, 1));
  }
}

TEST(KitchenScene, KitchenLoadsWhole) {
  const std::filesystem::path kitchen = std::filesystem::path(scenes_folder()) / "bitterli-kitchen";
  if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << "no folder " << kitchen << "; set KAIROS_SCENES";
  const TempFolder folder;
  convert(kitchen.string(), folder.path("kitchen"));
  const auto scene = load_scene({folder.path("kitchen/scene.json")});
  size_t triangles = 0;
  for (const SceneMesh& mesh : scene->meshes) triangles += mesh.triangles.size();
  EXPECT_EQ(scene->meshes.size(), 295u);
  EXPECT_EQ(triangles, 1443509u);  // as the files' headers count them
  EXPECT_TRUE(scene->warnings.empty());
}

}  // namespace
}  // namespace kairos
