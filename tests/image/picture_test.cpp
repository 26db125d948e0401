// Pictures that are read: formats, damage, and sizes that only the header claims.
#include <cmath>
#include <cstring>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include <kairos/image.h>

#include "error_matchers.h"
#include "image/pixels.h"
#include "image/read_exr.h"
#include "temp_folder.h"

namespace kairos {
namespace {

constexpr int kWidth = 3, kHeight = 2;
const std::vector<uint8_t> kCodes{255, 0,  0,  255, 0,  255, 0,  128, 0,  0,   255, 0,
                                  10,  20, 30, 40,  50, 60,  70, 80,  90, 100, 110, 120};

void append(void* bytes, void* data, int size) {
  const auto* begin = static_cast<const uint8_t*>(data);
  static_cast<std::vector<uint8_t>*>(bytes)->insert(static_cast<std::vector<uint8_t>*>(bytes)->end(), begin,
                                                    begin + size);
}

std::vector<uint8_t> png() {
  std::vector<uint8_t> bytes;
  stbi_write_png_to_func(append, &bytes, kWidth, kHeight, 4, kCodes.data(), kWidth * 4);
  return bytes;
}

TEST(Picture, PngAndTgaKeepTheirCodes) {
  std::vector<uint8_t> tga;
  stbi_write_tga_to_func(append, &tga, kWidth, kHeight, 4, kCodes.data());
  for (const auto& bytes : {png(), tga}) {
    const Pixels pixels = decode_picture(bytes, "test");
    EXPECT_EQ(pixels.width, kWidth);
    EXPECT_EQ(pixels.height, kHeight);
    EXPECT_EQ(pixels.codes, kCodes);
    EXPECT_TRUE(pixels.values.empty());
  }
}

TEST(Picture, JpegIsNearAndOpaque) {
  const std::vector<uint8_t> grey(16 * 16 * 3, 100);
  std::vector<uint8_t> bytes;
  stbi_write_jpg_to_func(append, &bytes, 16, 16, 3, grey.data(), 95);
  const Pixels pixels = decode_picture(bytes, "test");
  ASSERT_EQ(pixels.codes.size(), 16u * 16 * 4);
  for (size_t i = 0; i < pixels.codes.size(); ++i)
    EXPECT_NEAR(pixels.codes[i], i % 4 == 3 ? 255 : 100, i % 4 == 3 ? 0 : 2);
}

TEST(Picture, HdrIsLinear) {
  const std::vector<float> values{0.5f, 2, 8, 1, 0, 100};
  std::vector<uint8_t> bytes;
  stbi_write_hdr_to_func(append, &bytes, 2, 1, 3, values.data());
  const Pixels pixels = decode_picture(bytes, "test");
  EXPECT_TRUE(pixels.codes.empty());
  const std::vector<float> expected{0.5f, 2, 8, 1, 1, 0, 100, 1};
  ASSERT_EQ(pixels.values.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(pixels.values[i], expected[i], 0.01 * expected[i]);
}

TEST(Picture, ExrIsLinearAndWhatIsNotFiniteIsZero) {
  Image image{2, 1, 0, 0, 2, 1, {}, {}};
  image.channels = {{"R", Channel::Storage::colour, {0.25f, NAN}},
                    {"G", Channel::Storage::colour, {4, INFINITY}},
                    {"B", Channel::Storage::colour, {0, 1}}};
  const TempFolder folder;
  write_image(image, folder.path("a.exr"));
  EXPECT_EQ(read_picture(folder.path("a.exr")).values, (std::vector<float>{0.25f, 4, 0, 1, 0, 0, 1, 1}));
  image.channels.pop_back();
  write_image(image, folder.path("b.exr"));
  expect_error([&] { read_picture(folder.path("b.exr")); }, {"b.exr", "channels"});
}

TEST(Picture, ASizeThatOnlyTheHeaderClaimsIsRefusedBeforeAnythingIsAllocated) {
  std::vector<uint8_t> bytes = png();
  const uint8_t huge[8] = {0, 0, 0x40, 0, 0, 0, 0x40, 0};  // 16384 x 16384, big-endian, behind the IHDR's name
  std::memcpy(bytes.data() + 16, huge, sizeof(huge));
  expect_error([&] { decode_picture(bytes, "bomb.png"); }, {"bomb.png", "16384x16384"});
}

TEST(Picture, DamageIsOneClearError) {
  const std::vector<uint8_t> whole = png();
  expect_error([] { decode_picture({}, "empty"); }, {"empty"});
  expect_error([&] { decode_picture(std::span(whole).first(whole.size() / 2), "half.png"); }, {"half.png", "damaged"});
  const TempFolder folder;
  expect_error([&] { read_picture(folder.write("text.png", "no picture at all, by any means")); }, {"text.png"});
  expect_error([&] { read_picture(folder.path("none.jpg")); }, {"none.jpg"}, ErrorCode::io);
  uint32_t state = 1;
  for (int round = 0; round < 2000; ++round) {  // any damage: a picture or an error
    std::vector<uint8_t> bytes = whole;
    for (int i = 0; i < 3; ++i) {
      state = state * 1664525u + 1013904223u;
      bytes[(state >> 8) % bytes.size()] = static_cast<uint8_t>(state >> 24);
    }
    try {
      const Pixels pixels = decode_picture(bytes, "damaged");
      EXPECT_EQ(pixels.codes.size(), static_cast<size_t>(pixels.width) * static_cast<size_t>(pixels.height) * 4);
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace kairos
