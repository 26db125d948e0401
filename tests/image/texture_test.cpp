// Looking colours up in pictures.
#include "image/texture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shading/shader.h"

namespace kairos {
namespace {

Pixels grey(int width, int height, const std::vector<float>& values) {
  Pixels pixels{width, height, {}, {}};
  for (const float v : values) pixels.values.insert(pixels.values.end(), {v, v, v, 1});
  return pixels;
}

Pixels checkers(int size) {
  Pixels pixels{size, size, {}, {}};
  for (int i = 0; i < size * size; ++i) {
    const auto code = static_cast<uint8_t>((i % size + i / size) % 2 ? 255 : 0);
    pixels.codes.insert(pixels.codes.end(), {code, code, code, 255});
  }
  return pixels;
}

TEST(Texture, CodesOfColoursAreSrgbAndOfNumbersAreNot) {
  const Pixels pixels{1, 1, {188, 0, 255, 51}, {}};
  const Texel colour = Texture(pixels, Texture::Encoding::srgb).at({0.5f, 0.5f}, 0);
  EXPECT_NEAR(colour.colour.x, 0.5029, 1e-4);  // ((188 / 255 + 0.055) / 1.055)^2.4
  EXPECT_EQ(colour.colour.y, 0);
  EXPECT_EQ(colour.colour.z, 1);
  EXPECT_NEAR(colour.alpha, 0.2, 1e-6) << "alpha is never sRGB";
  EXPECT_NEAR(Texture(pixels, Texture::Encoding::linear).at({0.5f, 0.5f}, 0).colour.x, 188.0 / 255, 1e-6);
}

TEST(Texture, IsBilinearBetweenTexelCentresAndRepeats) {
  const Texture texture(grey(4, 2, {0, 1, 2, 3, 4, 5, 6, 7}), Texture::Encoding::srgb);
  const auto at = [&](float x, float y) { return texture.at({x / 4, y / 2}, 1).colour.x; };
  EXPECT_EQ(at(0.5f, 0.5f), 0) << "the upper left texel's centre";
  EXPECT_EQ(at(2.5f, 1.5f), 6);
  EXPECT_FLOAT_EQ(at(2, 0.5f), 1.5f);
  EXPECT_FLOAT_EQ(at(1.75f, 1.25f), 4.25f);
  EXPECT_FLOAT_EQ(at(0, 0.5f), 1.5f) << "half 3, half 0: it repeats";
  EXPECT_FLOAT_EQ(at(2.25f - 12, 1.5f + 6), at(2.25f, 1.5f));
  EXPECT_TRUE(std::isfinite(texture.at({NAN, INFINITY}, 1).colour.x));
  EXPECT_TRUE(std::isfinite(texture.at({1e30f, -1e30f}, INFINITY).colour.x));
}

TEST(Texture, BeyondItsEdgesItRepeatsStopsOrTurnsBack) {
  const Texture texture(grey(4, 1, {0, 1, 2, 3}), Texture::Encoding::srgb);
  const auto at = [&](float x, TextureWrap wrap, float footprint = 1) {
    return texture.at({x / 4, 0.5f}, footprint, {wrap, TextureWrap::repeat}).colour.x;
  };
  for (const float x : {0.0f, 0.5f, -1.0f, -100.0f}) EXPECT_EQ(at(x, TextureWrap::clamp), 0) << x;
  for (const float x : {3.5f, 4.0f, 7.0f}) EXPECT_EQ(at(x, TextureWrap::clamp), 3) << x;
  EXPECT_FLOAT_EQ(at(1, TextureWrap::clamp), 0.5f);
  for (const float x : {0.25f, 0.75f, 1.75f, 3.75f}) {
    EXPECT_FLOAT_EQ(at(-x, TextureWrap::mirror), at(x, TextureWrap::mirror)) << x;
    EXPECT_FLOAT_EQ(at(8 - x, TextureWrap::mirror), at(x, TextureWrap::mirror)) << x;
    EXPECT_FLOAT_EQ(at(x + 8, TextureWrap::mirror), at(x, TextureWrap::mirror)) << x;
  }
  EXPECT_EQ(at(4, TextureWrap::mirror), 3);
  EXPECT_EQ(at(5.5f, TextureWrap::mirror), 2);
  EXPECT_FLOAT_EQ(at(0, TextureWrap::clamp, 2), 0.5f) << "nothing of the other edge in coarser copies either";
  EXPECT_FLOAT_EQ(texture.at({-3, 0.5f}, 1e9f, {TextureWrap::clamp, TextureWrap::clamp}).colour.x, 1.5f);
  EXPECT_TRUE(std::isfinite(texture.at({NAN, INFINITY}, NAN, {TextureWrap::clamp, TextureWrap::mirror}).colour.x));

  // In squares, each texel up to its own edges, as long as it is wider than a pixel.
  const auto square = [&](float x, TextureWrap wrap, float footprint = 1) {
    return texture.at({x / 4, 0.5f}, footprint, {wrap, TextureWrap::repeat}, true).colour.x;
  };
  for (const float x : {0.01f, 0.5f, 0.99f, 4.5f, -3.5f}) EXPECT_EQ(square(x, TextureWrap::repeat), 0) << x;
  for (const float x : {3.01f, 3.99f, 4.0f, 9.0f}) EXPECT_EQ(square(x, TextureWrap::clamp), 3) << x;
  EXPECT_EQ(square(-1.5f, TextureWrap::mirror), 1);
  EXPECT_EQ(square(1.9f, TextureWrap::repeat, 0), 1);
  EXPECT_EQ(square(1, TextureWrap::repeat, 2), at(1, TextureWrap::repeat, 2));
  EXPECT_TRUE(std::isfinite(texture.at({NAN, INFINITY}, 1, {TextureWrap::clamp, TextureWrap::mirror}, true).colour.x));

  Shot shot;
  shot.materials.resize(1);
  shot.materials[0].base_color = {1, 1, 1};
  shot.materials[0].base_color_texture.wrap = {TextureWrap::clamp, TextureWrap::repeat};
  shot.textures = {{std::make_shared<const Texture>(texture), nullptr, nullptr}};
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.positions = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  mesh.uvs = {{1.5f, 0.5f}, {1.5f, 0.5f}, {1.5f, 0.5f}};
  shot.meshes = {mesh};
  EXPECT_EQ(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 3);
  shot.meshes[0].uvs = {{0.26f, 0.5f}, {0.26f, 0.5f}, {0.26f, 0.5f}};
  EXPECT_LT(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 1);
  shot.materials[0].base_color_texture.nearest = true;
  EXPECT_EQ(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 1);
  // Where nobody says, a few colours next to each other are not mixed, and what could be a picture is smooth.
  shot.materials[0].base_color_texture.nearest = std::nullopt;
  EXPECT_EQ(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 1);
  std::vector<float> many(17, 0.0f);
  many[4] = 1;
  shot.textures[0].base_color = std::make_shared<const Texture>(grey(17, 1, many), Texture::Encoding::linear);
  EXPECT_GT(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 0.1f);
  EXPECT_LT(Looks(shot).at(0, 0, {}, {1, 0, 0}, 0).base_colour.x, 0.99f);
}

TEST(Texture, FarAwayItIsItsMeanLight) {
  const Texture texture(checkers(64), Texture::Encoding::srgb);
  const float fine = texture.at({0.5f / 64, 0.5f / 64}, 1).colour.x,
              other = texture.at({1.5f / 64, 0.5f / 64}, 1).colour.x;
  EXPECT_EQ(std::abs(fine - other), 1);
  for (const float footprint : {2.0f, 5.0f, 64.0f, 1000.0f})
    EXPECT_NEAR(texture.at({0.3f, 0.7f}, footprint).colour.x, 0.5, 0.005) << "the mean of light, not of sRGB codes";
  EXPECT_NEAR(texture.at({0.5f / 64, 0.5f / 64}, std::sqrt(2.0f)).colour.x, 0.5 * fine + 0.25, 0.005)
      << "half way between two levels";
}

TEST(Texture, SidesThatAreNoPowersOfTwoKeepTheMean) {
  std::vector<float> values(7 * 5);
  float mean = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i * i % 17);
    mean += values[i] / static_cast<float>(values.size());
  }
  EXPECT_NEAR(Texture(grey(7, 5, values), Texture::Encoding::srgb).at({0.5f, 0.5f}, 100).colour.x, mean, 1e-4);
}

TEST(Texture, TheColourOfWhatIsTransparentDoesNotBleed) {
  Pixels pixels{2, 1, {0, 255, 0, 255, 255, 0, 0, 0}, {}};
  const Texture texture(pixels, Texture::Encoding::srgb);
  EXPECT_TRUE(texture.has_alpha());
  const Texel mean = texture.at({0.5f, 0.5f}, 2);
  EXPECT_NEAR(mean.alpha, 0.5, 0.01);
  EXPECT_EQ(mean.colour, (Vec3f{0, 1, 0}));
  pixels.codes[7] = 255;
  EXPECT_FALSE(Texture(pixels, Texture::Encoding::srgb).has_alpha());
}

// A square of 8 x 8 units, tilted away from the camera; u to the right, v down it.
Shot tilted_square(std::shared_ptr<const Texture> texture, float depth) {
  Shot shot;
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.positions = {{{-4, -4, -depth}, {4, -4, -depth}, {4, 4, -depth - 8}, {-4, 4, -depth - 8}}};
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  shot.meshes = {mesh};
  shot.materials.resize(1);
  shot.materials[0].base_color = {1, 0.5f, 0.25f};
  shot.materials[0].emission = {0, 0, 3};
  shot.textures = {{std::move(texture), nullptr, nullptr}};
  return shot;
}

TEST(Shader, TexturesFollowTheSurfaceAndNotTheScreen) {
  std::vector<float> ramp(256);
  for (size_t i = 0; i < ramp.size(); ++i) ramp[i] = (static_cast<float>(i) + 0.5f) / 256;  // equal to v at the centres
  const Shot shot = tilted_square(std::make_shared<const Texture>(grey(1, 256, ramp), Texture::Encoding::srgb), 2);
  const Shader shader(shot, ShadingKind::flat, false);
  for (const float v : {0.1f, 0.3f, 0.5f, 0.8f}) {
    const Vec3f point{1, 4 - 8 * v, -10 + 8 * v};
    const uint32_t triangle = 1 / 8.0f + 0.5f > 1 - v ? 0 : 1;
    const Shade shade = shader.shade({{0, 0, 0}, point / -point.z}, 0, triangle, 0.5f);
    EXPECT_NEAR(shade.albedo.x, v, 2e-3) << v;
    EXPECT_NEAR(shade.colour.y, v / 2, 1e-3);
    EXPECT_NEAR(shade.colour.z, v / 4 + 3, 1e-3) << "emission is not the base colour's affair";
  }
}

TEST(Shader, TexturesAreBlurredToAPixelsWidth) {
  const auto texture = std::make_shared<const Texture>(checkers(512), Texture::Encoding::srgb);
  // 64 texels per unit. A pixel of a picture of 540 rows with a view of 45 degrees is 0.0015 wide at distance 1.
  const auto contrast = [&](float depth) {
    const Shot shot = tilted_square(texture, depth);
    const Shader shader(shot, ShadingKind::flat, false);
    float low = 1, high = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3f point{static_cast<float>(i) / 64 / 3, 0.02f, -depth - 4.02f};
      const float value = shader.shade({{0, 0, 0}, point / -point.z}, 0, 0, 0).albedo.x;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    return high - low;
  };
  EXPECT_GT(contrast(1), 0.3f);
  EXPECT_LT(contrast(100), 0.02f) << "a pixel is ten texels wide there";
}

TEST(Shader, WhatMovesUnderATextureIsShadedAtManyInstants) {
  Shot shot = tilted_square(std::make_shared<const Texture>(checkers(4), Texture::Encoding::srgb), 2);
  EXPECT_FALSE(Shader(shot, ShadingKind::flat, false).varies(0));
  shot.meshes[0].positions.push_back(shot.meshes[0].positions[0]);
  shot.meshes[0].key_times = {0, 1};
  EXPECT_TRUE(Shader(shot, ShadingKind::flat, false).varies(0));
  shot.textures.clear();
  EXPECT_FALSE(Shader(shot, ShadingKind::flat, false).varies(0));
}

}  // namespace
}  // namespace kairos
