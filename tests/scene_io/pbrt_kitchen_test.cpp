// A whole scene: B. Bitterli's kitchen, against what a second reader of it makes of it.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/scene.h>

#include "data_folders.h"
#include "scene/scene.h"
#include "temp_folder.h"

namespace kairos {
namespace {

TEST(PbrtKitchen, IsAsTheNativeSceneMadeFromIt) {
  const std::filesystem::path kitchen = std::filesystem::path(scenes_folder()) / "bitterli-kitchen";
  if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << "no folder " << kitchen << "; set KAIROS_SCENES";
  const TempFolder folder;
  const std::string command = fmt::format("python3 '{}/tools/kitchen_scene.py' '{}' '{}' > /dev/null",
                                          KAIROS_SOURCE_DIR, kitchen.string(), folder.path("kitchen"));
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const auto native = load_scene({folder.path("kitchen/scene.json")});
  const auto scene = load_scene({(kitchen / "scene.pbrt").string()});

  ASSERT_EQ(native->meshes.size(), 295u);
  ASSERT_EQ(scene->meshes.size(), 299u) << "and four that shine";
  for (size_t i = 0; i < native->meshes.size(); ++i) {
    const SceneMesh &a = native->meshes[i], &b = scene->meshes[i];
    EXPECT_EQ(a.name, b.name);
    ASSERT_EQ(a.triangles, b.triangles) << a.name;
    std::vector<Vec3d> pa(a.motion->vertex_count()), pb(b.motion->vertex_count());
    ASSERT_EQ(pa.size(), pb.size());
    a.motion->positions(0, Side::after, pa);
    b.motion->positions(0, Side::after, pb);
    ASSERT_EQ(pa, pb) << a.name;
  }
  for (size_t i = 295; i < 299; ++i) EXPECT_GT(scene->materials[scene->meshes[i].material].emission.x, 10);
  EXPECT_NEAR(scene->cameras.at(0).vfov, native->cameras.at(0).vfov, 1e-12);
  const Mat4 a = native->cameras[0].motion->at(0, Side::after), b = scene->cameras[0].motion->at(0, Side::after);
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r) EXPECT_NEAR(a.m[c][r], b.m[c][r], 1e-5);
  EXPECT_EQ(scene->image_size, (std::array<int, 2>{1280, 720}));
  // One texture is absent.
  EXPECT_THAT(scene->warnings, testing::ElementsAre(testing::HasSubstr("scene.pbrt:26: the file 'textures/wood.tga'")));
}

}  // namespace
}  // namespace kairos
