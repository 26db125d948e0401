// Lights in Whitted's shading, against what they must bring, computed by hand.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "seed.h"
#include "shading/floor_scene.h"

namespace kairos {
namespace {

using test::expect_near;
using test::floor_shot;
using test::kDown;
using test::seen;

TEST(Whitted, LambertUnderAPointLight) {
  Shot shot = floor_shot();
  shot.lights = {PointLight{{4, 3, -2}, {10, 20, 30}}};
  // 3 to the side, 4 above: 5 away, cosine 4/5.
  const double factor = 0.8 / 25 / M_PI;
  expect_near(seen(shot, kDown), to_float({10 * 0.5 * factor, 20 * 0.25 * factor, 30 * factor}), 1e-6);
}

/// A lamp above the floor that shines to one side; which one, its winding says.
TEST(Whitted, ALampMayShineFromItsFrontAlone) {
  const Mesh down = parallelogram({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, 1),
             up = parallelogram({-1, 3, 1}, {2, 0, 0}, {0, 0, -2}, 1);
  const auto shot = [&](const Mesh& lamp_mesh, bool one_sided, bool cut_out) {
    Shot made = floor_shot({1, 1, 1});
    made.meshes.push_back(lamp_mesh);
    made.materials.push_back(lamp({5, 5, 5}));
    made.materials[1].one_sided_emission = one_sided;
    if (cut_out) {
      made.materials[1].alpha = 0;
      made.materials[1].alpha_mode = Material::AlphaMode::mask;
      made.materials[1].emits_where_cut_out = true;
    }
    return made;
  };
  const Ray on_floor{{0, 2, 0}, {0.125f, -1, 0.125f}}, on_lamp{{0, 0, 0}, {0.01f, 1, 0.01f}};
  constexpr uint32_t kMany = 256;
  const float lit = seen(shot(down, false, false), on_floor, kMany).x;
  EXPECT_GT(lit, 0.1f);
  EXPECT_EQ(seen(shot(down, true, false), on_floor, kMany).x, lit);
  EXPECT_NEAR(seen(shot(up, false, false), on_floor, kMany).x, lit, 1e-3);
  EXPECT_EQ(seen(shot(up, true, false), on_floor, kMany).x, 0);
  EXPECT_EQ(seen(shot(down, true, false), on_lamp).x, 5);
  EXPECT_EQ(seen(shot(up, true, false), on_lamp).x, 0);
  for (const ShadingKind kind : {ShadingKind::flat, ShadingKind::whitted}) {
    const Shot behind = shot(up, true, false);
    const auto scene = std::make_shared<const DiscreteScene>(behind.meshes);
    const Shader shader(behind, kind, false, 8, scene);
    EXPECT_EQ(shader.shade(on_lamp, 1, 0, 0.5f, {}).colour.x, 0);
  }
  // What is there to shine shows its light alone where light is not asked for, and its own colour from behind.
  Shot flat = shot(down, true, false);
  const auto flat_colour = [&] {
    return Shader(flat, ShadingKind::flat, false, 8, std::make_shared<const DiscreteScene>(flat.meshes))
        .shade(on_lamp, 1, 0, 0.5f, {})
        .colour.x;
  };
  flat.materials[1].base_color = {0.25f, 0.25f, 0.25f};
  EXPECT_EQ(flat_colour(), 5.25f);
  flat.materials[1].lamp = true;
  EXPECT_EQ(flat_colour(), 5);
  flat.meshes[1] = up;
  EXPECT_EQ(flat_colour(), 0.25f);
  // A film's limit darkens what is seen, and keeps its hue; light is not limited.
  Shot limited = shot(down, true, false);
  limited.materials[1].emission = {8, 2, 4};
  limited.background = {0, 6, 3};
  limited.brightest = 2;
  const Shader shader(limited, ShadingKind::whitted, false, 8, std::make_shared<const DiscreteScene>(limited.meshes));
  EXPECT_EQ(shader.shade(on_lamp, 1, 0, 0.5f, {}).colour, (Vec3f{2, 0.5f, 1}));
  EXPECT_EQ(limited.seen_background(), (Vec3f{0, 2, 1}));
  EXPECT_NEAR(seen(limited, on_floor, kMany).x, 8 / 5.0f * lit, 1e-3);
  // One that is cut out lights the floor as if it were there.
  EXPECT_EQ(seen(shot(down, true, true), on_floor, kMany).x, lit);
}

/// Where its triangles meet, each is in the other's plane up to rounding.
TEST(Whitted, ALampDoesNotLightItsOwnBack) {
  std::mt19937 random(test::seed());
  const auto number = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
  for (int i = 0; i < 100; ++i) {
    const Vec3f corner{number(), number(), -5 + number()}, u{2 + number(), number(), number()},
        v{number(), 2 + number(), number()};
    Shot shot;
    shot.meshes = {parallelogram(corner, v, u, 0)};  // faces away from the eye
    shot.materials = {lamp({5, 5, 5})};
    shot.materials[0].base_color = {0.5f, 0.5f, 0.5f};
    shot.materials[0].one_sided_emission = true;
    const float along = 0.5f + 0.4f * number();
    EXPECT_EQ(seen(shot, {{0, 0, 0}, corner + (u + v) * along}, 16), Vec3f{});
  }
}

TEST(Whitted, ADirectionalLightDoesNotFadeAndASpotDoes) {
  Shot shot = floor_shot({1, 1, 1});
  shot.lights = {DirectionalLight{normalize(Vec3f{0, -4, 3}), {M_PI, 0, 0}}};
  EXPECT_NEAR(seen(shot, kDown).x, 0.8, 1e-6);
  // From 2 above; its axis 30 degrees off the way to the point.
  SpotLight spot{{1, 1, -2}, to_float({std::sin(M_PI / 6), -std::cos(M_PI / 6), 0}), {4 * M_PI, 0, 0}, 1, 0};
  const auto lit = [&](double inner, double outer) {
    spot.cos_inner = static_cast<float>(std::cos(inner));
    spot.cos_outer = static_cast<float>(std::cos(outer));
    shot.lights = {spot};
    return seen(shot, kDown).x;
  };
  EXPECT_NEAR(lit(0.6, 0.7), 1, 1e-5) << "inside of the inner cone";
  EXPECT_EQ(lit(0.3, 0.5), 0) << "outside of the outer one";
  const double middle = std::cos(M_PI / 6), inner = std::cos(0.4), outer = std::cos(0.8);
  EXPECT_NEAR(lit(0.4, 0.8), std::pow((middle - outer) / (inner - outer), 2), 1e-5);
}

TEST(Whitted, ShadowsAreCastAtTheSamplesTime) {
  Shot shot = floor_shot();
  shot.lights = {PointLight{{1, 9, -2}, {100, 100, 100}}};
  Mesh blocker = box({0.5f, 1, -2.5f}, {1.5f, 2, -1.5f}, 0);  // in the light's way at first, then gone
  blocker.positions.push_back(blocker.positions[0]);
  for (Vec3f& p : blocker.positions[1]) p.x += 4;
  blocker.key_times = {0, 1};
  shot.meshes.push_back(blocker);
  EXPECT_EQ(seen(shot, kDown, 1, 8, 0.0f).x, 0);
  EXPECT_GT(seen(shot, kDown, 1, 8, 0.9f).x, 0.1f);
}

TEST(Whitted, ASquareLampGivesItsFormFactor) {
  Shot shot = floor_shot({1, 1, 1});
  shot.materials.push_back(lamp({3, 3, 3}));
  shot.meshes.push_back(parallelogram({0, 1, -3}, {2, 0, 0}, {0, 0, 2}, 1));  // 2 above (1, -1, -2), centred there
  // Four quarters of 1 x 1 at distance 2, each seen from below its corner: J. Howell, Radiation Configuration Factors.
  const double side = 0.5, root = std::sqrt(1 + side * side),
               quarter = 2 * side / root * std::atan(side / root) / (2 * M_PI);
  const Vec3f mean = seen(shot, kDown, 1024);
  EXPECT_NEAR(mean.x, 3 * 4 * quarter, 0.01);
  // Stratified: an eighth of the samples are as good as that already.
  EXPECT_NEAR(seen(shot, kDown, 128).x, 3 * 4 * quarter, 0.02);
  shot.meshes.push_back(box({0.9f, 0, -2.1f}, {1.1f, 0.2f, -1.9f}, 0));
  EXPECT_LT(seen(shot, kDown, 256).x, 0.99f * mean.x) << "a soft shadow";
  EXPECT_GT(seen(shot, kDown, 256).x, 0.5f * mean.x);
}

TEST(Whitted, ALampThatGrowsFromNothingAndShrinksAgainLights) {
  Shot shot = floor_shot({1, 1, 1});
  shot.materials.push_back(lamp({3, 3, 3}));
  Mesh square = parallelogram({0, 1, -3}, {2, 0, 0}, {0, 0, 2}, 1);
  const std::vector<Vec3f> centre(4, {1, 1, -2});
  square.key_times = {0, 0.5f, 1};
  square.positions = {centre, square.positions[0], centre};
  shot.meshes.push_back(square);
  // As in ASquareLampGivesItsFormFactor; `size` is that of a side over 2.
  const auto expected = [](double size) {
    const double side = 0.5 * size, root = std::sqrt(1 + side * side);
    return 3 * 4 * 2 * side / root * std::atan(side / root) / (2 * M_PI);
  };
  for (const float time : {0.25f, 0.5f, 0.8f})
    EXPECT_NEAR(seen(shot, kDown, 1024, 8, time).x, expected(1 - std::abs(2 * time - 1)), 0.01) << time;
  EXPECT_EQ(seen(shot, kDown, 64, 8, 0.0f).x, 0) << "no lamp, and no light that replaces it";
  EXPECT_EQ(seen(shot, kDown, 64, 8, 1.0f).x, 0);
  // One whose corners lie in a line at both keys, and not in between.
  Mesh crossing = square;
  crossing.triangles = {{0, 1, 2}};
  crossing.key_times = {0, 1};
  crossing.positions = {{{0, 1, -2}, {2, 1, -2}, {1, 1, -2}, {}}, {{1, 1, -3}, {1, 1, -1}, {1, 1, -2}, {}}};
  crossing.positions[1][2] = {1, 1, -2.5f};
  shot.meshes.back() = crossing;
  shot.materials[1] = lamp({3, 0, 0});
  const Vec3f colour = seen(shot, kDown, 256, 8, 0.5f);
  EXPECT_GT(colour.x, 0.01f);
  EXPECT_EQ(colour.y, 0) << "light that replaces it";
}

TEST(Whitted, LightsStayWhereTheyAreWhenTheCameraMoves) {
  Shot still = floor_shot();
  still.meshes.push_back(box({0.5f, 0, -4}, {1.2f, 1, -3}, 0));
  still.lights = {PointLight{{4, 3, -2}, {10, 20, 30}}, DirectionalLight{normalize(Vec3f{1, -2, 0.5f}), {1, 1, 1}},
                  SpotLight{{0, 4, 0}, normalize(Vec3f{0.1f, -1, -0.4f}), {9, 9, 9}, 0.95f, 0.5f}};
  const Vec3f expected = seen(still, kDown);
  Shot turned = still;  // seen from (3, 2, 1), after a turn about y
  const double angle = 0.7;
  const std::array<Vec3d, 3> axes{Vec3d{std::cos(angle), 0, -std::sin(angle)}, Vec3d{0, 1, 0},
                                  Vec3d{std::sin(angle), 0, std::cos(angle)}};
  const Vec3d eye{3, 2, 1};
  turned.world_from_camera = [&](double) { return axes; };
  turned.camera_position = [&](double) { return eye; };
  const auto turn = [&](Vec3d v) { return to_float({dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)}); };
  for (Mesh& mesh : turned.meshes)
    for (Vec3f& p : mesh.positions[0]) p = turn(to_double(p) - eye);
  const Ray ray{turn(Vec3d{} - eye), turn(to_double(kDown.direction))};
  expect_near(seen(turned, ray), expected, 1e-5);
  EXPECT_GT(expected.x, 0.05f);
}

TEST(Whitted, AShotWithoutLightIsDark) {
  const Shot shot = floor_shot({1, 1, 1});
  EXPECT_EQ(seen(shot, kDown, 4), Vec3f{});
}

TEST(Whitted, LightsThatMoveAreWhereTheyAreAtTheRaysTime) {
  const auto at = [](double time) {
    const auto x = static_cast<float>(8 * time - 4);
    return std::vector<Light>{PointLight{{x, 3, -2}, {10, 20, 30}},
                              SpotLight{{x, 4, 0}, normalize(Vec3f{1 - x, -5, -2}), {9, 9, 9}, 0.95f, 0.5f},
                              DirectionalLight{normalize(Vec3f{x, -2, 0.5f}), {1, 1, 1}}};
  };
  for (const size_t which : {0u, 1u, 2u}) {
    Shot moving = floor_shot();
    moving.meshes.push_back(box({0.5f, 0, -4}, {1.2f, 1, -3}, 0));  // whose shadow wanders
    Shot still = moving;
    moving.lights = {at(0)[which]};
    moving.moving_lights = {[&](double time) { return at(time)[which]; }};
    for (const double time : {0.0, 0.25, 0.5, 1.0}) {
      still.lights = {at(time)[which]};
      const auto when = static_cast<float>(time);
      EXPECT_EQ(seen(moving, kDown, 1, 8, when), seen(still, kDown, 1, 8, when)) << which << ' ' << time;
    }
    EXPECT_NE(seen(moving, kDown, 1, 8, 0.25f), seen(moving, kDown, 1, 8, 0.5f)) << which;
  }
}

TEST(Whitted, EveryIntegratorSeesTheMeanOfALightThatMoves) {
  // From where it is lit straight from above to where it is lit at a slant: the mean of 1 / (1 + 9 t^2)^(3/2).
  Shot shot = floor_shot({1, 1, 1});
  shot.projection.width = shot.projection.height = 1;
  shot.projection.vfov = 1e-3;
  shot.meshes = {parallelogram({-10, -10, -1}, {20, 0, 0}, {0, 20, 0}, 0)};
  shot.lights = {PointLight{{0, 0, 0}, {M_PI, M_PI, M_PI}}};
  shot.moving_lights = {[](double time) {
    return Light(PointLight{{static_cast<float>(3 * time), 0, 0}, {M_PI, M_PI, M_PI}});
  }};
  const double mean = 1 / std::sqrt(10.0);  // of the integral's t / sqrt(1 + 9 t^2)
  for (const IntegratorKind kind :
       {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::automatic}) {
    RenderParams params;
    params.integrator = kind;
    params.shading = ShadingKind::whitted;
    params.tc_rays = 64;
    params.shading_samples = 16;
    params.spp = 1024;
    EXPECT_NEAR(render(shot, params).find("R")->values[0], mean, 2e-3) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace kairos
