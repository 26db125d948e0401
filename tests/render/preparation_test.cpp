// What is done before the first pixel: once for a renderer, at the price of the crop, and the same for any crop.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "soup.h"

namespace kairos::preparation_test {
namespace {

constexpr IntegratorKind kAll[] = {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed,
                                   IntegratorKind::automatic};

Shot random_shot(int width, int height) {
  std::mt19937 random(test::seed());
  Shot shot;
  shot.meshes.push_back(test::random_soup(random, test::Motion::deform, 40));
  shot.meshes.push_back(test::random_soup(random, test::Motion::still, 40));
  shot.meshes.back().positions.resize(1);
  shot.projection.width = width;
  shot.projection.height = height;
  return shot;
}

RenderParams params_of(IntegratorKind integrator) {
  RenderParams params;
  params.integrator = integrator;
  params.tc_rays = 4;
  params.spp = 16;
  return params;
}

/// The part of an image that a crop holds.
std::vector<float> part_of(const Image& image, const Crop& crop) {
  std::vector<float> values;
  for (const Channel& channel : image.channels)
    for (int y = crop.y0; y < crop.y1; ++y)
      for (int x = crop.x0; x < crop.x1; ++x)
        values.push_back(channel.values[static_cast<size_t>((y - image.top) * image.width + x - image.left)]);
  return values;
}

TEST(Preparation, IsKeptByTheRenderer) {
  const Shot shot = random_shot(120, 80);
  for (const IntegratorKind integrator : {IntegratorKind::mixed, IntegratorKind::automatic}) {
    RenderParams params = params_of(integrator);
    params.crop = Crop{40, 60, 30, 50};
    Renderer renderer(shot);
    RenderStats first, second;
    const Image image = renderer.render(params, &first), again = renderer.render(params, &second);
    EXPECT_EQ(part_of(image, *params.crop), part_of(again, *params.crop));
    EXPECT_EQ(first.prices, second.prices);
    EXPECT_EQ(first.moving_pixels, second.moving_pixels);
    if (integrator == IntegratorKind::automatic) {
      EXPECT_LT(second.rays, first.rays) << "looked around twice";
    }
    // Other parameters are looked at anew, and change nothing for those before.
    params.seed = 7;
    RenderStats other, other_again;
    renderer.render(params, &other);
    renderer.render(params, &other_again);
    if (integrator == IntegratorKind::automatic) {
      EXPECT_GT(other.rays, other_again.rays);
    }
    params.seed = 0;
    EXPECT_EQ(part_of(image, *params.crop), part_of(renderer.render(params), *params.crop));
  }
}

TEST(Preparation, IsTheSameForAnyCropInAnyOrder) {
  const Shot shot = random_shot(300, 70);
  for (const IntegratorKind integrator : kAll) {
    RenderParams params = params_of(integrator);
    const Image whole = render(shot, params);
    Renderer renderer(shot);
    for (const Crop crop : {Crop{250, 300, 0, 20}, Crop{0, 3, 0, 70}, Crop{101, 118, 33, 52}, Crop{255, 257, 60, 70}}) {
      params.crop = crop;
      EXPECT_EQ(part_of(whole, crop), part_of(renderer.render(params), crop)) << int(integrator);
    }
  }
}

// The whole frame has four thousand million pixels: what is known of each of them would not fit into memory.
TEST(Preparation, OfASmallCropOfAHugeFrameIsSmall) {
  const Shot shot = random_shot(65536, 65536);
  for (const IntegratorKind integrator : kAll) {
    RenderParams params = params_of(integrator);
    params.crop = Crop{32000, 32016, 32000, 32016};
    const Image image = render(shot, params);
    params.crop = Crop{31990, 32020, 31990, 32020};
    EXPECT_EQ(part_of(image, {32000, 32016, 32000, 32016}),
              part_of(render(shot, params), {32000, 32016, 32000, 32016}));
  }
}

}  // namespace
}  // namespace kairos::preparation_test
