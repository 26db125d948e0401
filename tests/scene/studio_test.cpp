// The light that is lent to scenes without any, and what decides about it.
#include "scene/studio.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/scene.h>

#include "error_matchers.h"
#include "gltf_builder.h"
#include "image/texture.h"
#include "seed.h"
#include "temp_folder.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A cube around the origin, each side of which reaches `half` from it, without its `missing`th square.
Shot cube(float half, size_t missing = 6) {
  Shot shot;
  shot.materials = {lambert({0.5f, 0.5f, 0.5f})};
  shot.meshes = {box({-half, -half, -half}, {half, half, half}, 0)};
  auto& triangles = shot.meshes[0].triangles;
  if (missing < 6)
    triangles.erase(triangles.begin() + 2 * static_cast<std::ptrdiff_t>(missing),
                    triangles.begin() + 2 * static_cast<std::ptrdiff_t>(missing) + 2);
  return shot;
}

TEST(LookAround, SeesWhatIsClosedAndHowFarItIs) {
  EXPECT_EQ(look_around(Shot{}, {}).open, 1);
  const Surroundings inside = look_around(cube(3), {});
  EXPECT_EQ(inside.open, 0);
  EXPECT_GT(inside.distance, 3);
  EXPECT_LT(inside.distance, 3 * std::sqrt(3.0));
  EXPECT_EQ(look_around(cube(3), {100, 0, 0}).open, 1) << "far away from it";
  for (size_t side = 0; side < 6; ++side)
    EXPECT_NEAR(look_around(cube(3, side), {}).open, 1.0 / 6, 0.05) << "a sixth of all directions, side " << side;
}

TEST(LookAround, DoesNotDependOnScaleAndPlace) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> anywhere(-50, 50);
  for (const float half : {1e-6f, 1.0f, 1e6f}) {
    const Vec3d eye{anywhere(random), anywhere(random), anywhere(random)};
    Shot shot = cube(half);
    for (Vec3f& p : shot.meshes[0].positions[0]) p = p + to_float(eye * static_cast<double>(half));
    const Surroundings around = look_around(shot, eye * static_cast<double>(half));
    EXPECT_EQ(around.open, 0) << half;
    EXPECT_NEAR(around.distance / static_cast<double>(half), look_around(cube(1), {}).distance, 1e-3) << half;
  }
}

TEST(LookAround, LightComesThroughGlassAndCutOutsAndTheBacksOfOneSidedWalls) {
  Shot shot = cube(2);
  shot.materials[0].transmission = 1;
  EXPECT_EQ(look_around(shot, {}).open, 1);
  shot = cube(2);
  shot.materials[0].alpha_mode = Material::AlphaMode::mask;
  EXPECT_EQ(look_around(shot, {}).open, 1);
  shot = cube(2);
  shot.meshes[0].one_sided = true;
  EXPECT_EQ(look_around(shot, {}).open, 0) << "the fronts are outside, where the light comes from";
  for (Triangle& triangle : shot.meshes[0].triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_EQ(look_around(shot, {}).open, 1) << "the fronts are inside";
}

class Lending : public testing::Test {
 protected:
  Lending() { gltf_.triangle_node(); }

  Shot shot(LightChoice lights = LightChoice::automatic) const {
    ShotOptions options;
    options.lights = lights;
    return make_shot(gltf_.parse(), options);
  }
  void material(const nlohmann::json& material) {
    gltf_.root["materials"] = nlohmann::json::array({material});
    gltf_.root["meshes"][0]["primitives"][0]["material"] = 0;
  }

  GltfBuilder gltf_;
};

TEST_F(Lending, WhatBringsNoLightsGetsAStudioAndANote) {
  const Shot lit = shot();
  ASSERT_EQ(lit.lights.size(), 2u);
  ASSERT_EQ(lit.light_textures.size(), 2u);
  EXPECT_TRUE(lit.light_textures[0]) << "the soft environment";
  EXPECT_TRUE(std::holds_alternative<DirectionalLight>(lit.lights[1])) << "the key light";
  EXPECT_THAT(lit.notes, Contains(HasSubstr("studio")));
  for (const LightChoice choice : {LightChoice::file, LightChoice::none}) {
    EXPECT_TRUE(shot(choice).lights.empty());
    EXPECT_THAT(shot(choice).notes, Not(Contains(HasSubstr("studio"))));
  }
}

TEST_F(Lending, WhatOnlyGlowsIsNoLight) {
  material({{"emissiveFactor", {1, 0.5, 0}}});
  EXPECT_EQ(shot().lights.size(), 2u);
}

TEST_F(Lending, WhereNothingReflectsNothingIsLent) {
  material({{"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}});
  EXPECT_TRUE(shot().lights.empty());
}

TEST_F(Lending, TheFilesOwnLightsAreKeptOrReplacedAsAsked) {
  gltf_.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  gltf_.push("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const Shot own = shot();
  ASSERT_EQ(own.lights.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<PointLight>(own.lights[0]));
  EXPECT_THAT(own.notes, Not(Contains(HasSubstr("studio"))));
  const Shot studio = shot(LightChoice::studio);
  ASSERT_EQ(studio.lights.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<DirectionalLight>(studio.lights[1]));
  EXPECT_TRUE(shot(LightChoice::none).lights.empty());
}

TEST(Lights, ANativeSceneSaysThatItWantsNone) {
  const TempFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string rest = R"("meshes": [{"keys": ["a.obj"]}]})";
  ShotOptions options;
  options.lights = LightChoice::automatic;
  const auto lights = [&](const std::string& fields) {
    return make_shot(*load_scene({folder.write("s.json", R"({"kairos": 1, )" + fields + rest)}), options).lights.size();
  };
  EXPECT_EQ(lights(""), 2u);
  EXPECT_EQ(lights(R"("lights": [], )"), 0u);
  EXPECT_EQ(lights(R"("lights": [{"type": "constant", "radiance": [1, 1, 1]}], )"), 1u);
}

TEST(Studio, StandsUprightBehindTheCameraAndInAClosedRoomTheLightIsAtTheEye) {
  const double angle = 0.8, tilt = 0.5;  // about y, then downwards
  const Mat4 camera = rotation({0, std::sin(angle / 2), 0, std::cos(angle / 2)}) *
                      rotation({-std::sin(tilt / 2), 0, 0, std::cos(tilt / 2)});
  Shot shot;
  add_studio(shot, camera, {1, 1}, true);
  ASSERT_EQ(shot.lights.size(), 2u);
  const auto& environment = std::get<EnvironmentLight>(shot.lights[0]);
  EXPECT_EQ(environment.axes[1], (Vec3d{0, 1, 0}));
  EXPECT_NEAR(environment.axes[0].x, std::cos(angle), 1e-12);
  EXPECT_NEAR(environment.axes[0].z, -std::sin(angle), 1e-12);
  const Vec3d travels = to_double(std::get<DirectionalLight>(shot.lights[1]).direction);
  EXPECT_LT(travels.y, -0.3) << "from above";
  EXPECT_GT(dot(travels, environment.axes[0]), 0.2) << "from the left";
  EXPECT_LT(dot(travels, environment.axes[2]), -0.3) << "from behind the camera";

  Shot room;
  room.camera_position = [](double time) { return Vec3d{time, 2, 3}; };
  room.camera_moves = true;
  add_studio(room, camera, {0, 4}, true);
  ASSERT_EQ(room.moving_lights.size(), 2u);
  const auto at_the_eye = std::get<PointLight>(room.moving_lights[1](0.5));
  EXPECT_EQ(at_the_eye.position, (Vec3f{0.5f, 2, 3}));
  Shot larger = room;
  larger.lights.clear();
  add_studio(larger, camera, {0, 8}, true);
  EXPECT_FLOAT_EQ(std::get<PointLight>(larger.lights[1]).intensity.x, 4 * at_the_eye.intensity.x)
      << "walls twice as far away are as bright";
}

TEST(Environment, StandsInPlaceOfTheScenesAndTurns) {
  const TempFolder folder;
  Image image{2, 1, 0, 0, 2, 1, {}, {}};
  for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, Channel::Storage::colour, {3, 4}});
  write_image(image, folder.path("sky.exr"));
  folder.write("scene.json", R"({"kairos": 1, "lights": [{"type": "constant", "radiance": [1, 1, 1]},
      {"type": "point", "position": [0, 1, 0], "intensity": [1, 1, 1]}]})");
  const auto scene = load_scene({folder.path("scene.json")});
  ShotOptions options;
  options.lights = LightChoice::automatic;
  options.environment = {folder.path("sky.exr"), 90, 2};
  const Shot shot = make_shot(*scene, options);
  ASSERT_EQ(shot.lights.size(), 2u) << "the point light and the picture";
  const auto& environment = std::get<EnvironmentLight>(shot.lights[1]);
  EXPECT_EQ(environment.radiance, (Vec3f{2, 2, 2}));
  EXPECT_NEAR(environment.axes[0].z, -1, 1e-12) << "a quarter turn counter-clockwise, seen from above";
  ASSERT_TRUE(shot.light_textures.at(1));
  EXPECT_EQ(shot.light_textures[1]->width(), 2);
  options.environment->path = folder.path("none.hdr");
  expect_error([&] { make_shot(*scene, options); }, {"none.hdr"}, ErrorCode::io);
  options.environment = {folder.path("sky.exr"), std::nan(""), 1};
  expect_error([&] { make_shot(*scene, options); }, {"rotation"}, ErrorCode::bad_usage);
}

}  // namespace
}  // namespace kairos
