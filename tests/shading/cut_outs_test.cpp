// Surfaces cut out by their alpha: when they are there, and what is seen behind them.
#include "shading/cut_outs.h"

#include <cmath>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "image/texture.h"
#include "shading/shader.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

/// A leaf of 4 x 4 units at z = -4 with a round hole of radius `hole`, which moves by 2 to the right while the shutter
/// is open, before a wall at z = -8.
Shot leaf_shot(float hole, bool moves = true) {
  constexpr int kSize = 256;
  Pixels pixels{kSize, kSize, {}, {}};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double across = 4.0 / kSize, dx = (x + 0.5) * across - 2, dy = (y + 0.5) * across - 2;
      const double alpha = (std::hypot(dx, dy) - static_cast<double>(hole)) / across / 4 + 0.5;  // four texels wide
      pixels.values.insert(pixels.values.end(), {0, 1, 0, static_cast<float>(std::clamp(alpha, 0.0, 1.0))});
    }
  Shot shot;
  shot.materials = {lambert({1, 1, 1}), lambert({0, 0, 1})};
  shot.materials[0].alpha_mode = Material::AlphaMode::mask;
  shot.textures = {{std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::srgb), nullptr, nullptr}, {}};
  Mesh leaf = parallelogram({-2, -2, -4}, {4, 0, 0}, {0, 4, 0}, 0);
  leaf.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  if (moves) {
    leaf.positions.push_back(leaf.positions[0]);
    for (Vec3f& p : leaf.positions[1]) p.x += 2;
    leaf.key_times = {0, 1};
  }
  shot.meshes = {leaf, parallelogram({-20, -20, -8}, {40, 0, 0}, {0, 40, 0}, 1)};
  shot.projection.width = 32;
  shot.projection.height = 24;
  return shot;
}

TEST(CutOuts, HolesOpenAndCloseSegmentsAtTheRightTimes) {
  const Shot shot = leaf_shot(0.5f);
  const Shader shader(shot, ShadingKind::flat, false);
  ASSERT_TRUE(shader.cut_outs());
  const Ray ray{{0, 0, 0}, {1.0f / 4, 0.1f / 4, -1}};  // meets the leaf at x = 1 - 2 time from its middle, y = 0.1
  const double half_width = std::sqrt(0.25 - 0.01);
  const double opens = (1 - half_width) / 2, closes = (1 + half_width) / 2;
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(shot.meshes, {Precision::fast, set, shader.cut_outs()});
    Tracer::Workspace workspace;
    const auto seen = tracer.trace(ray, Visibility::visible, workspace);
    // Both triangles of the leaf may follow on each other.
    std::vector<Segment> joined;
    for (const Segment& s : seen) {
      if (joined.empty() || joined.back().mesh != s.mesh) joined.push_back(s);
      joined.back().end = s.end;
    }
    ASSERT_EQ(joined.size(), 3u) << to_string(set);
    EXPECT_EQ(joined[1].mesh, 1u) << "the wall through the hole";
    EXPECT_NEAR(joined[1].begin, opens, 5e-4);
    EXPECT_NEAR(joined[1].end, closes, 5e-4);
    EXPECT_EQ(joined[2].end, 1);
    EXPECT_NEAR(joined[0].dist_end, 4, 1e-5);
  }
  const DiscreteScene scene(shot.meshes, DiscreteOptions{true, shader.cut_outs()});
  EXPECT_EQ(scene.intersect(ray, static_cast<float>(opens) - 1e-3f)->mesh, 0u);
  EXPECT_EQ(scene.intersect(ray, static_cast<float>(opens) + 1e-3f)->mesh, 1u);
  const std::vector<Ray> rays(11, ray);
  std::vector<float> times(11, 0.5f);
  times[3] = 0.01f;
  std::vector<std::optional<DiscreteHit>> hits(11);
  scene.intersect(rays, times, hits);
  for (size_t i = 0; i < hits.size(); ++i) EXPECT_EQ(hits[i]->mesh, i == 3 ? 0u : 1u);
  EXPECT_FALSE(scene.intersect(ray, 0.5f, 7.9f)) << "nothing before the wall";
}

// The leaf's alpha rises from 0 at its left edge to 1 at its right one, by its vertices; it moves by 2 of its 4 units.
TEST(CutOuts, AlphaOfVerticesCutsAtTheRightTimeToo) {
  Shot shot = leaf_shot(0.5f);
  shot.textures.clear();
  shot.meshes[0].colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
  shot.materials[0].alpha_cutoff = 0.375f;
  const Shader shader(shot, ShadingKind::flat, false);
  ASSERT_TRUE(shader.cut_outs());
  // Meets the leaf at x = 0.25, which is 2.25 - 2 time from its left edge; it is cut where that is below 1.5.
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(shot.meshes, {Precision::fast, set, shader.cut_outs()});
    Tracer::Workspace workspace;
    const auto seen = tracer.trace({{0, 0, 0}, {0.25f / 4, 0.1f / 4, -1}}, Visibility::visible, workspace);
    ASSERT_GE(seen.size(), 2u);
    EXPECT_EQ(seen.front().mesh, 0u);
    EXPECT_EQ(seen.back().mesh, 1u);
    EXPECT_NEAR(seen.back().begin, 0.375, 2e-4) << to_string(set);
  }
  shot.materials[0].alpha_mode = Material::AlphaMode::blend;
  const Shader blended(shot, ShadingKind::flat, false);
  ASSERT_TRUE(blended.cut_outs());
  EXPECT_NEAR(blended.opacity({{0, 0, 0}, {0.25f / 4, 0, -1}}, 0, 0, 0), 2.25 / 4, 1e-6);
  shot.meshes[0].colors.assign(4, {0, 1, 0, 1});
  EXPECT_FALSE(Shader(shot, ShadingKind::flat, false).cut_outs()) << "all of it is there";
}

TEST(CutOuts, WhatStandsStillIsCutOutToo) {
  const Shot shot = leaf_shot(1, false);
  const Shader shader(shot, ShadingKind::normal, false);
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(shot.meshes, {Precision::fast, set, shader.cut_outs()});
    Tracer::Workspace workspace;
    const auto through = tracer.trace({{0, 0, 0}, {0.1f, 0, -1}}, Visibility::visible, workspace);
    ASSERT_EQ(through.size(), 1u);
    EXPECT_EQ(through[0].mesh, 1u);
    const auto beside = tracer.trace({{0, 0, 0}, {0.4f, 0, -1}}, Visibility::visible, workspace);
    ASSERT_EQ(beside.size(), 1u);
    EXPECT_EQ(beside[0].mesh, 0u);
  }
}

TEST(CutOuts, OnlyWhatSaysSoIsCutOut) {
  Shot shot = leaf_shot(1);
  shot.materials[0].alpha_mode = Material::AlphaMode::opaque;
  EXPECT_FALSE(Shader(shot, ShadingKind::flat, false).cut_outs());
  shot.materials[1].alpha_mode = Material::AlphaMode::mask;
  EXPECT_FALSE(Shader(shot, ShadingKind::flat, false).cut_outs()) << "its alpha is 1 all over";
  shot.materials[1].alpha = 0.25f;
  const Shader shader(shot, ShadingKind::flat, false);
  ASSERT_TRUE(shader.cut_outs());
  const Tracer tracer(shot.meshes, {Precision::fast, std::nullopt, shader.cut_outs()});
  Tracer::Workspace workspace;
  EXPECT_TRUE(tracer.trace({{0, 0, 0}, {2, 0, -1}}, Visibility::visible, workspace).empty()) << "the wall is gone";
}

TEST(CutOuts, APictureOfTheAlphaAloneGoesBeforeTheBaseColours) {
  Shot shot = leaf_shot(1, false);
  const auto picture = [](float value) {
    return std::make_shared<const Texture>(Pixels{1, 1, {}, {value, 1, 1, 1}}, Texture::Encoding::linear);
  };
  const Ray hole{{0, 0, 0}, {0.1f, 0, -1}}, leaf{{0, 0, 0}, {0.4f, 0, -1}};
  for (const bool there : {true, false}) {
    shot.textures[0].alpha = picture(there ? 0.75f : 0.25f);
    const Shader shader(shot, ShadingKind::flat, false);
    const DiscreteScene scene(shot.meshes, DiscreteOptions{true, shader.cut_outs()});
    EXPECT_EQ(scene.intersect(hole, 0.5f)->mesh, there ? 0u : 1u);
    EXPECT_EQ(scene.intersect(leaf, 0.5f)->mesh, there ? 0u : 1u);
  }
}

TEST(CutOuts, AllIntegratorsSeeThroughTheSameHole) {
  Shot shot = leaf_shot(0.7f);
  shot.lights = {ConstantLight{{0.4f, 0.4f, 0.4f}}, DirectionalLight{normalize(Vec3f{0.5f, -0.7f, -1}), {2, 2, 2}}};
  const auto blue = [&](IntegratorKind kind, ShadingKind shading) {
    RenderParams params;
    params.integrator = kind;
    params.shading = shading;
    params.tc_rays = 32;
    params.spp = 512;
    const Image image = render(shot, params);
    return image.find("B")->values;
  };
  for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::whitted}) {
    const auto qmc = blue(IntegratorKind::qmc, shading);
    for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed}) {
      const auto other = blue(kind, shading);
      double square = 0, contrast = 0;
      for (size_t i = 0; i < qmc.size(); ++i) {
        square += std::pow(qmc[i] - other[i], 2);
        contrast = std::max(contrast, std::abs(static_cast<double>(qmc[i]) - qmc[0]));
      }
      EXPECT_LT(std::sqrt(square / static_cast<double>(qmc.size())), 0.02 * contrast);
    }
  }
}

TEST(CutOuts, LightShinesThroughHoles) {
  Shot shot = leaf_shot(1, false);
  shot.lights = {PointLight{{0, 0, 0}, {100, 100, 100}}};
  const Shader shader(shot, ShadingKind::whitted, false);
  const auto lit = [&](float x) { return shader.shade({{x, 0, -6}, {0, 0, -1}}, 1, 0, 0.5f).colour.z; };
  EXPECT_GT(lit(1.0f), 0.1f) << "below the hole, half as far from the lamp";
  EXPECT_EQ(lit(3.0f), 0) << "behind the leaf";
  EXPECT_GT(lit(6.0f), 0.1f) << "beside it";
}

}  // namespace
}  // namespace kairos
