// Environments that pictures give: where light comes from, how much of it, and what is seen of them.
#include "shading/sky.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "image/texture.h"
#include "math/transform.h"
#include "seed.h"
#include "shading/shader.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

using Mapping = EnvironmentLight::Mapping;

Pixels even_picture(int width, int height, Vec3f colour) {
  Pixels pixels{width, height, {}, {}};
  for (int i = 0; i < width * height; ++i) pixels.values.insert(pixels.values.end(), {colour.x, colour.y, colour.z, 1});
  return pixels;
}
void set(Pixels& pixels, int x, int y, Vec3f colour) {
  for (int c = 0; c < 3; ++c) pixels.values[static_cast<size_t>((y * pixels.width + x) * 4 + c)] = colour[c];
}
Pixels random_picture(int width, int height) {
  std::mt19937 random(test::seed());
  Pixels pixels = even_picture(width, height, {});
  for (float& v : pixels.values) v = std::pow(std::uniform_real_distribution<float>(0, 1)(random), 8.0f);
  return pixels;
}

/// A shot lit by nothing but the picture.
Shot lit_by(Pixels pixels, EnvironmentLight light = {}) {
  Shot shot;
  shot.lights = {light};
  shot.light_textures = {std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::linear)};
  return shot;
}

Vec3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalize(Vec3d{normal(random), normal(random), normal(random)});
}

/// The turn that puts a picture's own axes where nothing lines up, and a reflection.
std::array<Vec3d, 3> skewed_axes() {
  const Mat4 turn = rotation(normalize(Quaternion{0.3, 0.5, -0.2, 0.8}));
  return {-transform_vector(turn, {1, 0, 0}), transform_vector(turn, {0, 1, 0}), transform_vector(turn, {0, 0, 1})};
}

TEST(Sky, PicturesLieWhereTheyShould) {
  constexpr Vec3f kMark{0, 1, 0};
  const auto marked = [&](Mapping mapping, int size, int x, int y,
                          std::array<Vec3d, 3> axes = EnvironmentLight{}.axes) {
    const bool round = mapping == Mapping::latitude_longitude;
    Pixels pixels = even_picture(round ? 2 * size : size, size, {1, 0, 0});
    set(pixels, x, y, kMark);
    return lit_by(std::move(pixels), {"", {1, 1, 1}, mapping, axes});
  };
  const auto is_mark = [&](const Shot& shot, Vec3d direction) {
    return Sky(shot).radiance(normalize(direction)).y > 0.99f;
  };
  constexpr double kSmall = 1e-9;
  // 3 rows of 60 degrees, 6 columns of 60 degrees; the middle of the picture is the border of columns 2 and 3.
  const auto round = [&](int x, int y) { return marked(Mapping::latitude_longitude, 3, x, y); };
  EXPECT_TRUE(is_mark(round(3, 1), {0.5, 0, -std::sqrt(0.75)})) << "right of the middle";
  EXPECT_TRUE(is_mark(round(4, 1), {1, 0, 0}));
  EXPECT_TRUE(is_mark(round(1, 1), {-1, 0, 0}));
  EXPECT_TRUE(is_mark(round(5, 1), {0.5, 0, std::sqrt(0.75)}));
  EXPECT_TRUE(is_mark(round(3, 0), {0.25, std::sqrt(0.75), -std::sqrt(0.1875)})) << "above";
  // Five by five fields of equal area.
  const auto square = [&](int x, int y) { return marked(Mapping::equal_area, 5, x, y); };
  EXPECT_TRUE(is_mark(square(2, 2), {kSmall, kSmall, 1}));
  EXPECT_TRUE(is_mark(square(0, 0), {-1e-3, -1e-3, -1}));
  EXPECT_TRUE(is_mark(square(4, 2), {1, kSmall, kSmall}));
  EXPECT_TRUE(is_mark(square(2, 4), {kSmall, 1, kSmall}));
  EXPECT_TRUE(is_mark(square(0, 2), {-1, kSmall, kSmall}));
  // With axes of its own.
  const auto axes = skewed_axes();
  EXPECT_TRUE(is_mark(marked(Mapping::latitude_longitude, 3, 4, 1, axes), axes[0]));
}

TEST(Sky, DirectionsAreAsLikelyAsTheirDensitySays) {
  for (const Mapping mapping : {Mapping::latitude_longitude, Mapping::equal_area}) {
    const bool round = mapping == Mapping::latitude_longitude;
    const Shot shot = lit_by(random_picture(round ? 16 : 8, 8), {"", {1, 2, 3}, mapping, skewed_axes()});
    const Sky sky(shot);
    std::mt19937 random(test::seed());
    std::uniform_real_distribution<float> unit(0, 0.99999f);
    constexpr int kCount = 1 << 17;
    double total = 0, back = 0;
    Vec3d uniform, sampled, uniform_light, sampled_light;
    for (int i = 0; i < kCount; ++i) {
      const Vec3d anywhere = random_direction(random);
      total += sky.density(anywhere) * 4 * M_PI / kCount;
      uniform += anywhere * (sky.density(anywhere) * 4 * M_PI / kCount);
      uniform_light += to_double(sky.radiance(anywhere)) * (4 * M_PI / kCount);
      const auto direction = sky.sample({unit(random), unit(random), unit(random)});
      ASSERT_TRUE(direction);
      EXPECT_NEAR(length(*direction), 1, 1e-9);
      sampled += *direction / kCount;
      ASSERT_GT(sky.density(*direction), 0);
      sampled_light += to_double(sky.radiance(*direction)) / (sky.density(*direction) * kCount);
      back += 1 / (sky.density(*direction) * kCount);
    }
    EXPECT_NEAR(total, 1, 0.02);
    EXPECT_NEAR(back, 4 * M_PI, 0.5);
    EXPECT_NEAR(length(sampled - uniform), 0, 0.02);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sampled_light[c], uniform_light[c], 0.02 * uniform_light[c]);
  }
}

TEST(Sky, LargePicturesAreCountedInCells) {
  // One texel of 3000 x 1500 shines, in a row near the upper edge.
  constexpr int kWidth = 3000, kHeight = 1500, kX = 1234, kY = 160;
  Pixels pixels = even_picture(kWidth, kHeight, {0, 0, 0});
  set(pixels, kX, kY, {1e6f, 1e6f, 1e6f});
  const Sky sky(lit_by(std::move(pixels)));
  const double texel = (std::cos(kY * M_PI / kHeight) - std::cos((kY + 1) * M_PI / kHeight)) * 2 * M_PI / kWidth;
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> unit(0, 0.99999f);
  double bright = 0;
  constexpr int kCount = 1 << 15;
  for (int i = 0; i < kCount; ++i) {
    const auto direction = sky.sample({unit(random), unit(random), unit(random)});
    ASSERT_TRUE(direction);
    bright += static_cast<double>(sky.radiance(*direction).x) / (sky.density(*direction) * kCount);
  }
  EXPECT_NEAR(bright, 1e6 * texel, 0.05 * 1e6 * texel);
}

TEST(Sky, PicturesAreMixedByTheirPower) {
  Shot shot = lit_by(even_picture(2, 1, {1, 1, 1}), {"", {1, 1, 1}, Mapping::latitude_longitude, skewed_axes()});
  Pixels spot = even_picture(16, 8, {});
  set(spot, 3, 2, {90, 90, 90});
  shot.lights.push_back(EnvironmentLight{});
  shot.light_textures.push_back(std::make_shared<const Texture>(std::move(spot), Texture::Encoding::linear));
  const Sky sky(shot);
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> unit(0, 0.99999f);
  double sum = 0, bright = 0;
  constexpr int kCount = 1 << 18;  // 0.05 below is then six standard deviations
  for (int i = 0; i < kCount; ++i) {
    sum += sky.density(random_direction(random)) * 4 * M_PI / kCount;
    const auto direction = sky.sample({unit(random), unit(random), unit(random)});
    bright += static_cast<double>(sky.radiance(*direction).x) / (sky.density(*direction) * kCount);
  }
  const double row = std::cos(2 * M_PI / 8) - std::cos(3 * M_PI / 8), texel = row * 2 * M_PI / 16;
  EXPECT_NEAR(sum, 1, 0.05);
  EXPECT_NEAR(bright, 4 * M_PI + 90 * texel, 0.02 * bright);
  EXPECT_FALSE(Sky(lit_by(even_picture(2, 1, {}))).sample({0.5f, 0.5f, 0.5f})) << "black";
}

/// Mean colour of what `ray` sees of mesh 0 over many samples.
Vec3d mean_colour(const Shot& shot, const Ray& ray, uint32_t count = 1 << 14) {
  const Shader shader(shot, ShadingKind::whitted, false);
  Vec3d sum;
  for (uint32_t i = 0; i < count; ++i) sum += to_double(shader.shade(ray, 0, 0, 0.5f, {3, i}).colour) / count;
  return sum;
}

/// A floor at y = -1, a wall beside it, a lid above.
Shot furnished(Shot shot, Material material) {
  shot.materials = {material, lambert({0, 0, 0})};
  shot.meshes = {parallelogram({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, 0), box({0.5f, -1, -50}, {0.6f, 4, 50}, 1)};
  return shot;
}

TEST(Sky, AnEvenPictureLightsAsTheConstantLightDoes) {
  const Ray ray{{0, 0, 0}, {0, -1, -1}};
  Shot constant;
  constant.lights = {ConstantLight{{0.5f, 1, 2}}};
  const Vec3d expected = mean_colour(furnished(constant, lambert({0.5f, 0.5f, 0.5f})), ray);
  EXPECT_LT(expected.x, 0.2) << "the wall takes its share";
  for (const Mapping mapping : {Mapping::latitude_longitude, Mapping::equal_area}) {
    const bool round = mapping == Mapping::latitude_longitude;
    const Vec3d seen = mean_colour(
        furnished(lit_by(even_picture(round ? 64 : 32, 32, {0.25f, 0.5f, 1}), {"", {2, 2, 2}, mapping, skewed_axes()}),
                  lambert({0.5f, 0.5f, 0.5f})),
        ray);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.01 * expected[c]);
  }
}

TEST(Sky, ABrightTexelIsADistantLight) {
  constexpr int kHeight = 128, kX = 40, kY = 31;
  Pixels pixels = even_picture(2 * kHeight, kHeight, {});
  set(pixels, kX, kY, {1000, 2000, 3000});
  const double polar = (kY + 0.5) * M_PI / kHeight, longitude = ((kX + 0.5) / (2 * kHeight) - 0.5) * 2 * M_PI;
  const Vec3d from{std::sin(polar) * std::sin(longitude), std::cos(polar), -std::sin(polar) * std::cos(longitude)};
  const double solid_angle = (std::cos(kY * M_PI / kHeight) - std::cos((kY + 1) * M_PI / kHeight)) * M_PI / kHeight;
  Shot sun;
  sun.lights = {DirectionalLight{to_float(-from), to_float(Vec3d{1000, 2000, 3000} * solid_angle)}};

  Material glossy = lambert({0.5f, 0.5f, 0.5f});
  glossy.roughness = 0.5f;
  glossy.metallic = 0.5f;
  const Vec3d mirrored = {from.x, -from.y, from.z};
  for (const Material& material : {lambert({0.5f, 0.5f, 0.5f}), glossy})
    // Beside the wall, in the light; on its other side, in the shadow; and where the highlight is seen.
    for (const Ray& ray : {Ray{{0, 0, 0}, {-1, -1, 0}}, Ray{{0.9f, 0, 0}, {0, -1, 0}},
                           Ray{to_float(Vec3d{-9, 0, 0} - from), to_float(mirrored)}}) {
      const Vec3d expected = mean_colour(furnished(sun, material), ray, 1);
      const Vec3d seen = mean_colour(furnished(lit_by(pixels), material), ray);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.015 * expected[c] + 1e-4);
    }
}

TEST(Sky, HighlightsKeepTheirLight) {
  // What the lobe reflects of an even sky, whichever way directions are chosen: its share, less what it loses below the
  // horizon and between its own bumps.
  Material metal = lambert({1, 1, 1});
  metal.metallic = 1;
  metal.roughness = 0.5f;
  const auto lit = [&](Pixels pixels) {
    Shot shot = lit_by(std::move(pixels));
    shot.materials = {metal};
    shot.meshes = {parallelogram({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, 0)};
    return mean_colour(shot, {{0, 0, 0}, {0, -1, -0.5f}}).x;
  };
  const double even = lit(even_picture(4, 2, {1, 1, 1}));
  EXPECT_GT(even, 0.93);
  EXPECT_LT(even, 1.0);
  // A black lower half makes no difference to a floor, but other directions are chosen.
  Pixels half = even_picture(64, 32, {1, 1, 1});
  for (int y = 17; y < 32; ++y)
    for (int x = 0; x < 64; ++x) set(half, x, y, {});
  EXPECT_NEAR(lit(half), even, 0.01);
}

TEST(Sky, MirrorsShowIt) {
  Pixels pixels = even_picture(4, 2, {});
  for (int x = 0; x < 4; ++x) set(pixels, x, 0, {1, 2, 3});
  Shot shot = lit_by(std::move(pixels));
  shot.background = {9, 9, 9};
  shot.materials = {mirror({1, 1, 1})};
  shot.meshes = {parallelogram({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, 0)};
  const Vec3d up = mean_colour(shot, {{0, 0, 0}, {0, -1, -0.1f}}, 1);
  EXPECT_NEAR(up.x, 1, 1e-3);
  EXPECT_NEAR(up.z, 3, 1e-3);
}

/// A ball that flies past in front of the picture while the camera turns by a tenth.
Shot turning_shot() {
  Shot shot = lit_by(random_picture(64, 32));
  shot.materials = {lambert({0.5f, 0.6f, 0.7f})};
  Mesh flies = ball({-1, 0, -4}, 0.7f, 6, 0);
  flies.positions.push_back(flies.positions[0]);
  for (Vec3f& p : flies.positions[1]) p.x += 2;
  flies.key_times = {0, 1};
  shot.meshes = {flies, parallelogram({-3, -1, -6}, {3, 0, 0}, {0, 1, 0}, 0)};
  shot.background = {0.1f, 0, 0};
  shot.camera_moves = true;
  shot.world_from_camera = [](double time) {
    const Mat4 turn = rotation({0, std::sin(0.05 * time), 0, std::cos(0.05 * time)});
    return std::array{transform_vector(turn, {1, 0, 0}), transform_vector(turn, {0, 1, 0}),
                      transform_vector(turn, {0, 0, 1})};
  };
  shot.projection.width = 16;
  shot.projection.height = 12;
  return shot;
}

TEST(Sky, AllIntegratorsSeeItTurn) {
  const Shot shot = turning_shot();
  for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::whitted}) {
    const auto green = [&](IntegratorKind kind, int rays, int threads = 0) {
      RenderParams params;
      params.integrator = kind;
      params.shading = shading;
      params.tc_rays = params.spp = rays;
      params.threads = threads;
      return render(shot, params).find("G")->values;
    };
    const auto reference = green(IntegratorKind::qmc, 1024);
    double brightest = 0;
    for (const float v : reference) brightest = std::max(brightest, static_cast<double>(v));
    EXPECT_GT(brightest, 0.2);
    for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic}) {
      const auto other = green(kind, kind == IntegratorKind::automatic ? 1024 : 128);
      double square = 0, difference = 0;
      for (size_t i = 0; i < other.size(); ++i) {
        square += std::pow(reference[i] - other[i], 2) / static_cast<double>(other.size());
        difference += (reference[i] - other[i]) / static_cast<double>(other.size());
      }
      EXPECT_LT(std::sqrt(square), 0.02) << static_cast<int>(kind);
      EXPECT_LT(std::abs(difference), 2e-3) << static_cast<int>(kind);
    }
    EXPECT_EQ(green(IntegratorKind::tc, 8, 1), green(IntegratorKind::tc, 8, 2));
  }
}

TEST(Sky, WhatIsBeyondEverything) {
  Shot shot = lit_by(even_picture(4, 2, {0.5f, 0.5f, 0.5f}));
  shot.background = {0.25f, 0, 0};
  shot.projection.width = shot.projection.height = 2;
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed}) {
    RenderParams params;
    params.integrator = kind;
    params.aovs = {Aov::coverage, Aov::depth};
    params.shading = ShadingKind::flat;
    const Image image = render(shot, params);
    EXPECT_NEAR(image.find("R")->values[0], 0.75f, 1e-6) << "beside the background";
    EXPECT_NEAR(image.find("G")->values[0], 0.5f, 1e-6);
    EXPECT_EQ(image.find("coverage.A")->values[0], 0);
    EXPECT_EQ(image.find("depth.Z")->values[0], INFINITY);
    params.shading = ShadingKind::normal;
    EXPECT_EQ(render(shot, params).find("G")->values[0], 0);
  }
  EXPECT_NEAR(Sky(shot).radiance({0, 1, 0}, 100).x, 0.5f, 1e-6) << "seen through a pixel as wide as all of it";
}

TEST(Sky, WithoutAPictureItIsEven) {
  Shot shot = lit_by(even_picture(1, 1, {}), {"", {0.5f, 0.5f, 0.5f}, Mapping::latitude_longitude, {}});
  shot.light_textures.clear();
  EXPECT_TRUE(Sky(shot).empty());
  EXPECT_NEAR(mean_colour(furnished(shot, lambert({1, 1, 1})), {{-49, 0, 0}, {0, -1, 0}}).x, 0.5, 0.02);
}

}  // namespace
}  // namespace kairos
