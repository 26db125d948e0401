// Differences between pictures, and pictures put side by side.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <kairos/compare.h>
#include <kairos/error.h>

#include "image/text.h"

namespace kairos {
namespace {

/// Red is 100 y + x, green and blue are constant.
Image numbered(int width, int height, float green = 0, float blue = 0) {
  Image image;
  image.width = image.frame_width = width;
  image.height = image.frame_height = height;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  image.channels = {{"R", Channel::Storage::colour, std::vector<float>(pixels)},
                    {"G", Channel::Storage::colour, std::vector<float>(pixels, green)},
                    {"B", Channel::Storage::colour, std::vector<float>(pixels, blue)}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.channels[0].values[static_cast<size_t>(y * width + x)] = static_cast<float>(100 * y + x);
  return image;
}

float red(const Image& image, int x, int y) {
  return image.channels[0].values[static_cast<size_t>(y * image.width + x)];
}

TEST(Compare, PsnrIsThatOfTheMeanOverPixelsAndColours) {
  const Image reference = numbered(4, 3, 0.5f, 2.0f);
  Image image = numbered(4, 3, 0.5f, 2.25f);
  Difference found = difference(reference, image, "image");
  EXPECT_DOUBLE_EQ(found.mse, 0.25 * 0.25 / 3);
  EXPECT_NEAR(found.psnr, 10 * std::log10(3 / (0.25 * 0.25)), 1e-12);

  // One pixel of the twelve, one colour of the three.
  image = numbered(4, 3, 0.5f, 2.0f);
  image.channels[1].values[7] = 0.75f;
  EXPECT_DOUBLE_EQ(difference(reference, image, "image").mse, 0.25 * 0.25 / 36);
}

TEST(Compare, EqualPicturesAreInfinitelyGood) {
  const Difference found = difference(numbered(5, 2), numbered(5, 2), "image");
  EXPECT_EQ(found.mse, 0);
  EXPECT_EQ(found.psnr, std::numeric_limits<double>::infinity());
}

TEST(Compare, WhatCannotBeComparedIsAnErrorThatNamesThePicture) {
  const auto message = [](const Image& image) -> std::string {
    try {
      difference(numbered(4, 3), image, "a.exr");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(numbered(3, 4)).find("a.exr: is 3x4"), std::string::npos);
  Image image = numbered(4, 3);
  image.channels[0].values[6] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message(image).find("a.exr: pixel (2, 1)"), std::string::npos);
  image = numbered(4, 3);
  image.channels[2].name = "depth.Z";
  EXPECT_NE(message(image).find("a.exr: has no channel B"), std::string::npos);
}

TEST(Compare, PanelsStandSideBySideWithTheirMagnifiedPartBelow) {
  const Image first = numbered(20, 10), second = numbered(20, 10, 1);
  const std::vector<Panel> panels{{&first, ""}, {&second, ""}};
  const PixelBox zoom{6, 2, 6, 4};
  const Image result = side_by_side(panels, zoom);
  const int gap = result.width - 40, factor = 3;  // 20 / 6, rounded down
  ASSERT_GT(gap, 0);
  ASSERT_EQ(result.height, 10 + gap + 4 * factor);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x) {
      const bool on_outline = (x == 5 || x == 12) ? (y >= 1 && y <= 6) : (y == 1 || y == 6) && x > 5 && x < 12;
      EXPECT_EQ(red(result, x, y), on_outline ? 1 : red(first, x, y)) << x << ", " << y;
      EXPECT_EQ(red(result, 20 + gap + x, y), red(result, x, y)) << x << ", " << y;
    }
  for (int y = 0; y < 4 * factor; ++y)
    for (int x = 0; x < 6 * factor; ++x)
      EXPECT_EQ(red(result, x, 10 + gap + y), red(first, 6 + x / factor, 2 + y / factor)) << x << ", " << y;
  EXPECT_EQ(result.channels[1].values.front(), 0);
  EXPECT_EQ(result.channels[1].values.back(), 0) << "a magnified part leaves the rest of its panel black";
}

TEST(Compare, APartOutsideThePictureIsAnError) {
  const Image image = numbered(20, 10);
  const std::vector<Panel> panels{{&image, ""}};
  for (const PixelBox& zoom : {PixelBox{-1, 0, 5, 5}, PixelBox{16, 0, 5, 5}, PixelBox{0, 6, 5, 5}, PixelBox{0, 0, 0, 5},
                               PixelBox{2147483647, 0, 5, 5}, PixelBox{0, 0, 21, 5}})
    EXPECT_THROW(side_by_side(panels, zoom), Error) << zoom.x << ", " << zoom.y << ", " << zoom.width;
  EXPECT_NO_THROW(side_by_side(panels, PixelBox{15, 5, 5, 5}));
}

TEST(Compare, TextLeavesInkInsideThePictureAndOnlyThere) {
  Image image = numbered(60, 20);
  for (float& value : image.channels[0].values) value = 0.5f;
  draw_text(image, 30, 2, 1, "tc 45.1 dB \xc3\xa9 and much more than fits");
  int white = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 60; ++x) {
      const bool outside = x < 30 || y < 2 || y >= 2 + text_height(1);
      EXPECT_TRUE(!outside || red(image, x, y) == 0.5f) << x << ", " << y;
      white += red(image, x, y) == 1;
    }
  EXPECT_GT(white, 30);
  EXPECT_LT(white, 30 * text_height(1) / 2);
}

}  // namespace
}  // namespace kairos
