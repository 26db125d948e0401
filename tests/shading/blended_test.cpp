// Blended surfaces: how much is seen of them and through them, and when.

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "image/texture.h"
#include "seed.h"
#include "shading/shader.h"
#include "soup.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr Vec3f kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1};

Material blended(Vec3f colour, float alpha) {
  Material material = lambert(colour);
  material.alpha_mode = Material::AlphaMode::blend;
  material.alpha = alpha;
  return material;
}

/// Moves by `way` while the shutter is open.
Mesh moving(Mesh mesh, Vec3f way) {
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions[1]) p = p + way;
  mesh.key_times = {0, 1};
  return mesh;
}

/// Faces the camera, 2 wide around (x, 0, z).
Mesh pane(float x, float z, uint32_t material) {
  Mesh mesh = parallelogram({x - 1, -1, z}, {2, 0, 0}, {0, 2, 0}, material);
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  return mesh;
}
Mesh wall(float z, uint32_t material) { return parallelogram({-20, -20, z}, {40, 0, 0}, {0, 40, 0}, material); }

/// One pixel, so small that all of it sees the same.
Shot point_shot(std::vector<Material> materials, std::vector<Mesh> meshes) {
  Shot shot;
  shot.materials = std::move(materials);
  shot.meshes = std::move(meshes);
  shot.projection.width = shot.projection.height = 1;
  shot.projection.orthographic = true;
  shot.projection.view_height = 1e-4;
  return shot;
}

Image picture(const Shot& shot, IntegratorKind kind, int rays, ShadingKind shading = ShadingKind::flat,
              int threads = 0) {
  RenderParams params;
  params.integrator = kind;
  params.shading = shading;
  params.tc_rays = rays;
  params.spp = rays;
  params.threads = threads;
  params.aovs = {Aov::coverage, Aov::depth, Aov::mesh};
  return render(shot, params);
}

void expect_colour(const Image& image, Vec3f colour, float tolerance) {
  EXPECT_NEAR(image.find("R")->values[0], colour.x, tolerance);
  EXPECT_NEAR(image.find("G")->values[0], colour.y, tolerance);
  EXPECT_NEAR(image.find("B")->values[0], colour.z, tolerance);
}

/// All integrators: the time-continuous ones exactly, as all is constant between changes.
void expect_everywhere(const Shot& shot, Vec3f colour, float coverage) {
  for (const auto& [kind, rays, tolerance] : {std::tuple{IntegratorKind::tc, 1, 2e-4f},
                                              {IntegratorKind::qmc, 1 << 14, 0.015f},
                                              {IntegratorKind::mixed, 1 << 10, 0.06f},
                                              {IntegratorKind::automatic, 1 << 14, 0.015f}}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const Image image = picture(shot, kind, rays);
    expect_colour(image, colour, tolerance);
    EXPECT_NEAR(image.find("coverage.A")->values[0], coverage, tolerance);
  }
}

TEST(Blended, HalfOfTheTimeInFrontOfAWall) {
  expect_everywhere(
      point_shot({blended(kRed, 0.5f), lambert(kBlue)}, {moving(pane(-2, -4, 0), {4, 0, 0}), wall(-8, 1)}),
      {0.25f, 0, 0.75f}, 1);
}

TEST(Blended, StandingStillToo) {
  expect_everywhere(point_shot({blended(kRed, 0.25f), lambert(kBlue)}, {pane(0, -4, 0), wall(-8, 1)}),
                    {0.25f, 0, 0.75f}, 1);
}

TEST(Blended, OneThatStandsStillBeforeWhatMoves) {
  expect_everywhere(
      point_shot({blended(kRed, 0.25f), lambert(kBlue)}, {pane(0, -4, 0), moving(pane(-2, -8, 1), {4, 0, 0})}),
      {0.25f, 0, 0.375f}, 0.625f);
}

TEST(Blended, BeforeTheBackground) {
  Shot shot = point_shot({blended(kRed, 0.5f)}, {moving(pane(-2, -4, 0), {4, 0, 0})});
  shot.background = {0, 0.5f, 0};
  expect_everywhere(shot, {0.25f, 0.375f, 0}, 0.25f);
  EXPECT_NEAR(picture(shot, IntegratorKind::tc, 1).find("depth.Z")->values[0], 4, 1e-4);
}

TEST(Blended, TwoThatCrossInDepth) {
  // The red one passes the green one after a quarter of the time.
  expect_everywhere(point_shot({blended(kRed, 0.5f), blended(kGreen, 0.5f), lambert(kBlue)},
                               {moving(pane(0, -4, 0), {0, 0, -4}), pane(0, -5, 1), wall(-9, 2)}),
                    {0.3125f, 0.4375f, 0.25f}, 1);
}

TEST(Blended, OneThatGoesThroughTheWall) {
  expect_everywhere(
      point_shot({blended(kRed, 0.5f), lambert(kBlue)}, {moving(pane(0, -4, 0), {0, 0, -8}), wall(-6, 1)}),
      {0.125f, 0, 0.875f}, 1);
}

TEST(Blended, TwoInOnePlace) {  // as leaves have that are drawn on both sides
  Mesh back = pane(0, -4.37f, 1);
  for (Triangle& triangle : back.triangles) std::swap(triangle[1], triangle[2]);
  expect_everywhere(
      point_shot({blended(kRed, 0.5f), blended(kRed, 0.25f), lambert(kBlue)}, {pane(0, -4.37f, 0), back, wall(-9, 2)}),
      {0.625f, 0, 0.375f}, 1);
}

TEST(Blended, ManyPiecesOfWhatTurnsBehind) {
  // A wall that comes to meet the pane and goes back: it hides it from a quarter to three quarters of the time.
  Mesh swings = wall(-8, 1);
  swings.positions.assign(3, swings.positions[0]);
  for (Vec3f& p : swings.positions[1]) p.z = -4;
  swings.key_times = {0, 0.5f, 1};
  expect_everywhere(point_shot({blended(kRed, 0.5f), lambert(kBlue)}, {pane(0, -6, 0), swings}), {0.25f, 0, 0.75f}, 1);
}

TEST(Blended, WhatHidesNothingStaysOutOfTheSegments) {
  const Shot shot = point_shot({blended(kRed, 0.5f), lambert(kBlue)},
                               {moving(pane(0, -4, 0), {0, 0, -8}), wall(-6, 1), pane(0, -3, 0)});
  const Shader shader(shot, ShadingKind::flat, false);
  for (const InstructionSet set : supported_instruction_sets())
    for (const Precision precision : {Precision::fast, Precision::exact}) {
      const Tracer tracer(shot.meshes, {precision, set, shader.cut_outs()});
      Tracer::Workspace workspace;
      const Ray ray{{0.1f, 0.2f, 0}, {0, 0, -1}};
      const auto seen = tracer.trace(ray, Visibility::visible, workspace);
      ASSERT_EQ(seen.size(), 1u) << to_string(set);
      EXPECT_EQ(seen[0].mesh, 1u);
      EXPECT_EQ(seen[0].duration(), 1);
      const auto blended = workspace.blended();
      ASSERT_EQ(blended.size(), 2u);
      EXPECT_EQ(blended[0].mesh, 0u);
      EXPECT_NEAR(blended[0].end, 0.25f, 1e-5);
      EXPECT_NEAR(blended[0].dist_end, 6, 1e-4);
      EXPECT_EQ(blended[1].mesh, 2u);
      EXPECT_EQ(blended[1].duration(), 1);
      EXPECT_EQ(tracer.trace(ray, Visibility::all, workspace).size(), 3u);
      EXPECT_TRUE(workspace.blended().empty());
    }
}

TEST(Blended, OpaqueWhereAlphaIsOne) {
  EXPECT_FALSE(Shader(point_shot({blended(kRed, 1)}, {pane(0, -4, 0)}), ShadingKind::flat, false).cut_outs());
  Shot shot = point_shot({blended(kRed, 1), lambert(kBlue)}, {pane(0, -4, 0), wall(-8, 1)});
  shot.textures = {{std::make_shared<const Texture>(Pixels{1, 1, {255, 255, 255, 51}, {}}, Texture::Encoding::srgb),
                    nullptr, nullptr},
                   {}};
  expect_everywhere(shot, {0.2f, 0, 0.8f}, 1);
}

TEST(Blended, AlphaAlongThePathOfTheHitPoint) {
  // Alpha grows as the square along u, which the pane's motion takes across the pixel in the middle half of the time.
  constexpr int kSize = 256;
  Pixels pixels{kSize, 1, {}, {}};
  double mean = 0;
  for (int x = 0; x < kSize; ++x) {
    const float alpha = std::pow((static_cast<float>(x) + 0.5f) / kSize, 2.0f);
    pixels.values.insert(pixels.values.end(), {1, 1, 1, alpha});
    mean += static_cast<double>(alpha) / kSize;
  }
  Shot shot = point_shot({blended(kRed, 0.5f), lambert(kBlue)}, {moving(pane(-2, -4, 0), {4, 0, 0}), wall(-8, 1)});
  shot.textures = {{std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::srgb), nullptr, nullptr}, {}};
  const auto red = static_cast<float>(0.25 * mean);
  expect_colour(picture(shot, IntegratorKind::tc, 64), {red, 0, 1 - red}, 5e-4f);
  expect_colour(picture(shot, IntegratorKind::qmc, 1 << 14), {red, 0, 1 - red}, 0.01f);
}

TEST(Blended, ShadowsAndReflectionsLetThroughAsMuch) {
  Shot shot;
  shot.materials = {blended({1, 1, 1}, 0.25f), lambert({1, 1, 1}), mirror({1, 1, 1}), lamp({0, 1, 0})};
  shot.lights = {DirectionalLight{{0, 0, -1}, {3, 3, 3}}};
  shot.meshes = {moving(pane(0, -4, 0), {0.5f, 0, 0}), wall(-8, 1)};
  const Shader shadow(shot, ShadingKind::whitted, false);
  const auto mean = [](const Shader& shader, uint32_t mesh, auto ray_at) {
    Vec3d sum;
    constexpr uint32_t kCount = 1 << 14;
    for (uint32_t i = 0; i < kCount; ++i) {
      const float time = (static_cast<float>(i) + 0.5f) / kCount;
      sum += to_double(shader.shade(ray_at(time), mesh, 0, time, {7, i}).colour) / kCount;
    }
    return sum;
  };
  const auto behind = [](float x) { return [x](float) { return Ray{{x, 0.3f, -6}, {0, 0, -1}}; }; };
  const Vec3d shaded = mean(shadow, 1, behind(0)), lit = mean(shadow, 1, behind(5));
  EXPECT_NEAR(lit.x, 3 / M_PI, 1e-3);
  EXPECT_NEAR(shaded.x / lit.x, 0.75, 0.015);

  // A mirror that sees a lamp through the pane.
  shot.lights = {ConstantLight{{0, 0, 0}}};
  shot.meshes = {pane(0, -4, 0), wall(-8, 2), wall(2, 3)};
  shot.materials[0].base_color = {0, 0, 0};
  const Shader reflection(shot, ShadingKind::whitted, false);
  const auto skewed = [](float time) { return Ray{{0, 0, -6}, {0.01f * time, 0, -1}}; };
  EXPECT_NEAR(mean(reflection, 1, skewed).y, 0.75, 0.03) << "less what the black pane reflects at its surface";
}

TEST(Blended, LampsShineAsMuchAsTheyAreThere) {
  Shot shot;
  shot.materials = {lamp({4, 4, 4}), lambert({1, 1, 1})};
  shot.meshes = {pane(0, -4, 0), wall(-8, 1)};
  const Ray ray{{0, 0, -6}, {0, 0, -1}};
  const auto lit = [&] {
    const Shader shader(shot, ShadingKind::whitted, false);
    return shader.shade(ray, 1, 0, 0.5f, {7, 0}).colour.x;
  };
  const float whole = lit();
  EXPECT_GT(whole, 0.1f);
  shot.materials[0].alpha_mode = Material::AlphaMode::blend;
  shot.materials[0].alpha = 0.25f;
  EXPECT_NEAR(lit(), 0.25f * whole, 1e-6f);
  shot.materials[0].alpha_mode = Material::AlphaMode::mask;
  EXPECT_EQ(lit(), 0);
}

/// Panes that move and turn in front of each other and of what is opaque.
Shot crowd() {
  std::mt19937 random(test::seed());
  const auto number = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  Shot shot;
  shot.materials = {blended({1, 0.3f, 0.1f}, 0.6f), blended({0.1f, 1, 0.2f}, 0.3f), lambert({0.2f, 0.3f, 1})};
  shot.background = {0.1f, 0.1f, 0.1f};
  for (uint32_t i = 0; i < 24; ++i) {
    Mesh mesh = pane(number(-2, 2), number(-9, -4), i % 3);
    if (i % 4 != 0) {
      mesh = moving(mesh, {number(-3, 3), number(-1, 1), number(-3, 3)});
      for (Vec3f& p : mesh.positions[1]) p.z += number(-2, 2);
    }
    shot.meshes.push_back(mesh);
  }
  shot.projection.width = 16;
  shot.projection.height = 12;
  return shot;
}

TEST(Blended, AllIntegratorsAgree) {
  const Shot shot = crowd();
  for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::normal}) {
    const Image reference = picture(shot, IntegratorKind::qmc, 2048, shading);
    for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic}) {
      const Image other = picture(shot, kind, kind == IntegratorKind::automatic ? 2048 : 128, shading);
      for (const char* channel : {"R", "G", "B", "coverage.A"}) {
        const auto &a = reference.find(channel)->values, &b = other.find(channel)->values;
        double square = 0, difference = 0;
        for (size_t i = 0; i < a.size(); ++i) {
          square += std::pow(a[i] - b[i], 2) / static_cast<double>(a.size());
          difference += (a[i] - b[i]) / static_cast<double>(a.size());
        }
        EXPECT_LT(std::sqrt(square), 0.018) << channel << " " << static_cast<int>(kind);
        EXPECT_LT(std::abs(difference), 2e-3) << channel << " " << static_cast<int>(kind);
      }
    }
  }
}

TEST(Blended, TheSameForAnyNumberOfThreads) {
  Shot shot = crowd();
  shot.lights = {ConstantLight{{0.5f, 0.5f, 0.5f}}};
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::automatic})
    EXPECT_EQ(picture(shot, kind, 16, ShadingKind::whitted, 1).find("R")->values,
              picture(shot, kind, 16, ShadingKind::whitted, 2).find("R")->values);
}

/// 12 red panes that each hide half, and behind them green ones, so bright that just as much is seen of them.
Shot many_panes(int green) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 12; ++i) meshes.push_back(moving(pane(0, -4 - 0.1f * static_cast<float>(i), 0), {0, 0, 0.01f}));
  for (int i = 0; i < green; ++i)
    meshes.push_back(moving(pane(0, -6 - 0.1f * static_cast<float>(i), 1), {0, 0, 0.01f}));
  return point_shot({blended(kRed, 0.5f), blended({0, 4096, 0}, 0.5f)}, meshes);
}

TEST(Blended, WhatLittleComesThroughManyIsRightInTheMean) {
  const uint32_t seed = test::seed();
  const Shot shot = many_panes(38);
  double sum = 0, squares = 0, red = 0;
  constexpr int kPictures = 400;
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.shading = ShadingKind::flat;
  params.tc_rays = 4;
  for (int i = 0; i < kPictures; ++i) {
    params.seed = seed + static_cast<uint32_t>(i);
    const Image image = render(shot, params);
    const double green = image.find("G")->values[0];
    sum += green;
    squares += green * green;
    red += image.find("R")->values[0];
  }
  const double mean = sum / kPictures, deviation = std::sqrt((squares / kPictures - mean * mean) / (kPictures - 1));
  // 4096 of green behind red panes that leave 2^-12; 38 green ones hide nearly all that is behind.
  EXPECT_LT(std::abs(mean - 1), 4.5 * deviation) << mean << " +- " << deviation;
  EXPECT_LT(deviation, 0.1);
  EXPECT_NEAR(red / kPictures, 1 - 0x1p-12, 2e-4);
}

TEST(Blended, ManyCostAsMuchAsThoseThatCanBeSeen) {
  // Panes that cross the ray one after the other and each other in depth.
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<double> samples;
  for (const int count : {80, 160, 320}) {
    samples.push_back(0);
    for (int scene = 0; scene < 2; ++scene) {
      std::vector<Mesh> meshes;
      for (int i = 0; i < count; ++i)
        meshes.push_back(moving(pane(2 * unit(random) - 1, -4 - 4 * unit(random), 0),
                                {2 * unit(random) - 1, 0, 4 * unit(random) - 2}));
      RenderParams params;
      params.integrator = IntegratorKind::tc;
      params.shading = ShadingKind::flat;
      params.tc_rays = 4;
      RenderStats stats;
      render(point_shot({blended(kRed, 0.75f)}, meshes), params, &stats);
      samples.back() += static_cast<double>(stats.shading_samples);
    }
  }
  // Twice as many panes come and go in front, and no more than twice as often something changes there.
  EXPECT_LT(samples[1], 3 * samples[0]);
  EXPECT_LT(samples[2], 3 * samples[1]);
  EXPECT_LT(samples[2], 2 * 4 * 320 * 40);
}

}  // namespace
}  // namespace kairos
