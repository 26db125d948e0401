// Pictures whose background is nothing: alpha is exact in time.
#include <gtest/gtest.h>

#include <kairos/render.h>

#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr IntegratorKind kAll[] = {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed,
                                   IntegratorKind::automatic};

/// Four pixels side by side, narrow enough for a pixel to see one point; a bar at z = -4 that goes over the first two
/// during a quarter of the shutter each, and a wall that stands still behind the last two.
Shot bar_shot(Material bar) {
  Shot shot;
  shot.projection.width = 4;
  shot.projection.height = 1;
  shot.projection.orthographic = true;
  shot.projection.view_height = 1;  // four units wide: x from -2 to 2
  bar.emission = {0.5f, 0.25f, 0};
  bar.base_color = {0, 0, 0};
  Material wall = lamp({0, 0, 0.5f});
  shot.materials = {bar, wall};
  Mesh moving = parallelogram({-3, -1, -4}, {1, 0, 0}, {0, 2, 0}, 0);
  moving.positions.push_back(moving.positions[0]);
  for (Vec3f& p : moving.positions[1]) p.x += 4;  // its front edge goes from -2 to 2, its back edge from -3 to 1
  moving.key_times = {0, 1};
  shot.meshes = {moving, parallelogram({0, -1, -5}, {2, 0, 0}, {0, 2, 0}, 1)};
  shot.background = {9, 9, 9};
  shot.backdrop = Vec3f{};
  return shot;
}

TEST(Alpha, IsTheShareOfTheShutterInWhichAnythingIsSeen) {
  for (const IntegratorKind kind : kAll)
    for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::whitted})
      for (const float opacity : {1.0f, 0.5f}) {
        Material bar;
        bar.alpha = opacity;
        bar.alpha_mode = opacity < 1 ? Material::AlphaMode::blend : Material::AlphaMode::opaque;
        RenderParams params;
        params.integrator = kind;
        params.shading = shading;
        params.alpha = true;
        params.tc_rays = 16;
        params.spp = 4096;
        const Image image = render(bar_shot(bar), params);
        ASSERT_EQ(image.channels.size(), 4u);
        const auto& alpha = image.find("A")->values;
        const auto& red = image.find("R")->values;
        const auto& blue = image.find("B")->values;
        // Over each pixel, which is as wide as the bar, the mean of how long it is seen: a quarter of the shutter each.
        const double exact = kind == IntegratorKind::tc || kind == IntegratorKind::mixed ? 1e-5 : 0.01;
        for (const size_t pixel : {0u, 1u}) {
          EXPECT_NEAR(alpha[pixel], opacity / 4, exact) << static_cast<int>(kind) << ' ' << pixel;
          EXPECT_NEAR(red[pixel], 0.5 * opacity / 4, exact) << "premultiplied, and nothing of the background";
          EXPECT_EQ(blue[pixel], 0);
        }
        EXPECT_NEAR(alpha[3], 1, 1e-5) << static_cast<int>(kind);
        EXPECT_NEAR(blue[3], 0.5 * (1 - opacity / 8), 0.01) << "the bar's front covers half of it in the last quarter";
      }
}

TEST(Alpha, ABackdropIsSeenInPlaceOfTheBackground) {
  Shot shot = bar_shot(Material{});
  shot.backdrop = Vec3f{0, 0, 2};
  for (const IntegratorKind kind : kAll) {
    RenderParams params;
    params.integrator = kind;
    params.shading = ShadingKind::flat;
    params.spp = 1024;
    const Image image = render(shot, params);
    EXPECT_EQ(image.channels.size(), 3u);
    EXPECT_NEAR(image.find("B")->values[0], 2 * 0.75, 0.02);
    EXPECT_NEAR(image.find("R")->values[0], 0.5 * 0.25, 0.01);
  }
}

}  // namespace
}  // namespace kairos
