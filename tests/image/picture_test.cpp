// Pictures that are read: formats, what their values mean, damage, and sizes that only the header claims.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <kairos/image.h>

#include "base/file.h"
#include "error_matchers.h"
#include "image/pixels.h"
#include "image/read_exr.h"
#include "image/texture.h"
#include "picture_files.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

constexpr int kWidth = 3, kHeight = 2;
const Bytes kCodes{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110, 120};

Bytes png() { return encode_png(kCodes, kWidth, kHeight, 4, "test"); }

Bytes codes_of(const Bytes& file) {
  const Pixels pixels = decode_picture(file, "test");
  EXPECT_TRUE(pixels.values.empty() && pixels.wide_codes.empty());
  return pixels.codes;
}

/// Blue before red, as TGA has them.
Bytes swapped(Bytes codes) {
  for (size_t i = 0; i < codes.size(); i += 4) std::swap(codes[i], codes[i + 2]);
  return codes;
}

Bytes webp() {
  uint8_t* data = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(kCodes.data(), kWidth, kHeight, kWidth * 4, &data);
  Bytes bytes(data, data + size);
  WebPFree(data);
  return bytes;
}

Bytes exr(const TempFolder& folder) {
  Image image{kWidth, kHeight, 0, 0, kWidth, kHeight, {}, {}};
  for (const char* name : {"R", "G", "B"})
    image.channels.push_back({name, Channel::Storage::exact, {0.25f, 0.5f, 4, 0, 1, 2}});
  write_image(image, folder.path("whole.exr"));
  return read_file(folder.path("whole.exr"), 1 << 20);
}

/// Two rows of ten texels, run-length encoded.
Bytes encoded_hdr() {
  Bytes rest;
  for (int row = 0; row < 2; ++row) {
    append(rest, Bytes{2, 2, 0, 10});
    for (const uint8_t value : {128, 64, 32}) append(rest, Bytes{uint8_t{128 + 7}, value, 3, 200, value, 100});
    append(rest, Bytes{uint8_t{128 + 10}, 129});
  }
  return hdr_file(10, 2, rest);
}

Bytes encoded_tga() {
  return tga_file(3, 2, {.kind = 10, .bits = 24, .flags = 0x20},
                  {0x83, 1, 2, 3, 1, 4, 5, 6, 7, 8, 9});  // four of one colour, across the end of a row, then two
}

Bytes jpeg() {
  Bytes codes(16 * 16 * 3);
  for (size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<uint8_t>(i * 7 % 200);
  return encode_jpeg(codes, 16, 16, 3, 95, "test");
}

TEST(Picture, PngKeepsItsCodes) {
  const Pixels pixels = decode_picture(png(), "test");
  EXPECT_EQ(pixels.width, kWidth);
  EXPECT_EQ(pixels.height, kHeight);
  EXPECT_EQ(codes_of(png()), kCodes);
  const uint8_t left = 0b10100000, alpha = 99;
  EXPECT_EQ(codes_of(png_file(3, 1, 1, 0, {0, left})), (Bytes{255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255}))
      << "one bit of grey";
  EXPECT_EQ(codes_of(png_file(2, 1, 2, 3, {0, 0b01000000}, {1, 2, 3, 4, 5, 6}, {alpha})),
            (Bytes{4, 5, 6, 255, 1, 2, 3, alpha}))
      << "a palette with one colour that is not opaque";
  EXPECT_EQ(codes_of(png_file(1, 1, 8, 4, {0, 7, 8})), (Bytes{7, 7, 7, 8})) << "grey with alpha";
  EXPECT_EQ(codes_of(png_file(1, 1, 8, 0, {0, 7}, {}, {0, 7})), (Bytes{7, 7, 7, 0}))
      << "the grey that stands for nothing";
}

TEST(Picture, PngOfSixteenBitsKeepsThem) {
  std::mt19937 random(test::seed());
  std::vector<uint16_t> codes(4 * 4 * 3);
  Bytes rows;
  for (size_t i = 0; i < codes.size(); ++i) {
    if (i % 12 == 0) rows.push_back(0);
    codes[i] = static_cast<uint16_t>(random());
    rows.push_back(static_cast<uint8_t>(codes[i] >> 8));
    rows.push_back(static_cast<uint8_t>(codes[i]));
  }
  const Bytes file = png_file(4, 4, 16, 2, rows);
  const Pixels pixels = decode_picture(file, "test");
  ASSERT_EQ(pixels.wide_codes.size(), 4u * 4 * 4);
  for (size_t i = 0; i < pixels.wide_codes.size(); ++i)
    EXPECT_EQ(pixels.wide_codes[i], i % 4 == 3 ? 65535 : codes[i / 4 * 3 + i % 4]);

  const Pixels near{2, 1, {}, {}, {1000, 0, 0, 65535, 1001, 0, 0, 65535}};
  const auto at = [&](float u, Texture::Encoding encoding) {
    return Texture(near, encoding).at({u, 0.5f}, 0).colour.x * 65535;
  };
  EXPECT_NEAR(at(0.25f, Texture::Encoding::linear), 1000, 0.01);
  EXPECT_NEAR(at(0.75f, Texture::Encoding::linear), 1001, 0.01);
  EXPECT_NEAR(at(0.25f, Texture::Encoding::srgb), 1000 / 12.92, 0.01) << "the straight part of the curve";

  const TempFolder folder;
  const Image image = read_image(folder.write("a.png", {reinterpret_cast<const char*>(file.data()), file.size()}));
  const float code = static_cast<float>(codes[0]) / 65535;
  EXPECT_NEAR(image.find("R")->values[0], code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f),
              1e-6);
}

TEST(Picture, TgaOfEveryKind) {
  EXPECT_EQ(codes_of(tga_file(kWidth, kHeight, {.bits = 32, .flags = 0x20}, swapped(kCodes))), kCodes);
  EXPECT_EQ(codes_of(tga_file(1, 2, {.bits = 24}, {1, 2, 3, 4, 5, 6})), (Bytes{6, 5, 4, 255, 3, 2, 1, 255}))
      << "rows from below, unless it says otherwise";
  EXPECT_EQ(codes_of(tga_file(2, 1, {.bits = 24, .flags = 0x30}, {1, 2, 3, 4, 5, 6})),
            (Bytes{6, 5, 4, 255, 3, 2, 1, 255}))
      << "columns from the right";
  EXPECT_EQ(codes_of(encoded_tga()), (Bytes{3, 2, 1, 255, 3, 2, 1, 255, 3, 2, 1, 255,  //
                                            3, 2, 1, 255, 6, 5, 4, 255, 9, 8, 7, 255}));
  EXPECT_EQ(codes_of(tga_file(2, 1, {.kind = 1, .bits = 8, .palette_entries = 2, .palette_bits = 24},
                              {1, 2, 3, 4, 5, 6, 1, 0})),
            (Bytes{6, 5, 4, 255, 3, 2, 1, 255}));
  EXPECT_EQ(codes_of(tga_file(2, 1, {.kind = 3, .bits = 8}, {7, 8})), (Bytes{7, 7, 7, 255, 8, 8, 8, 255}));
  EXPECT_EQ(codes_of(tga_file(1, 1, {.bits = 16}, {0b00011111, 0b01111100})), (Bytes{255, 0, 255, 255}));
  expect_error(
      [] {
        decode_picture(
            tga_file(1, 1, {.kind = 1, .bits = 8, .palette_entries = 2, .palette_bits = 24}, {1, 2, 3, 4, 5, 6, 2}),
            "t.tga");
      },
      {"t.tga", "palette"});
}

TEST(Picture, WebpWithoutLossesKeepsItsCodes) {
  Bytes expected = kCodes;
  for (size_t i = 0; i < expected.size(); i += 4)
    if (expected[i + 3] == 0) expected[i] = expected[i + 1] = expected[i + 2] = 0;  // its encoder drops what is unseen
  EXPECT_EQ(codes_of(webp()), expected);
}

TEST(Picture, JpegIsNearAndOpaque) {
  for (const int channels : {1, 3}) {
    const Bytes file = encode_jpeg(Bytes(16 * 16 * static_cast<size_t>(channels), 100), 16, 16, channels, 95, "test");
    const Bytes codes = codes_of(file);
    ASSERT_EQ(codes.size(), 16u * 16 * 4);
    for (size_t i = 0; i < codes.size(); ++i) EXPECT_NEAR(codes[i], i % 4 == 3 ? 255 : 100, i % 4 == 3 ? 0 : 2);
  }
}

TEST(Picture, ProgressiveJpegIsReadAndItsScansAreCounted) {
  const Bytes few = progressive_jpeg(2), many = progressive_jpeg(100);
  for (const uint8_t code : codes_of(many)) EXPECT_TRUE(code == 255 || (code >= 126 && code <= 130)) << int{code};
  const uint64_t step = picture_cost(few, "few").steps;
  EXPECT_EQ(step, 64u * (1 + 2)) << "the picture, and each scan's way over it";
  EXPECT_EQ(picture_cost(many, "many").steps, 64u * (1 + 100));
  EXPECT_EQ(picture_cost(jpeg(), "baseline").steps, 16u * 16) << "one pass";
}

TEST(Picture, HdrIsLinear) {
  // Mantissas of 1/2, 2 and 8 with the exponent of 16; then 1, 0 and 100; in plain texels.
  const Pixels plain = decode_picture(hdr_file(2, 1, {8, 32, 128, 132, 2, 0, 200, 135}), "test");
  EXPECT_EQ(plain.values, (std::vector<float>{0.5f, 2, 8, 1, 1, 0, 100, 1}));
  const Pixels repeated =
      decode_picture(hdr_file(300, 1, {128, 64, 0, 129, 1, 1, 1, 0x2a, 1, 1, 1, 1, 0, 0, 0, 0}), "test");
  ASSERT_EQ(repeated.values.size(), 300u * 4);
  for (size_t x = 0; x < 299; ++x) EXPECT_EQ(repeated.values[x * 4], 1) << x;
  EXPECT_EQ(repeated.values[299 * 4], 0);
  const Pixels encoded = decode_picture(encoded_hdr(), "test");
  ASSERT_EQ(encoded.values.size(), 2u * 10 * 4);
  for (const size_t row : {0, 1}) {
    const float* const values = &encoded.values[row * 40];
    for (size_t x = 0; x < 7; ++x) EXPECT_EQ(values[x * 4], 1) << x;
    EXPECT_EQ(values[7 * 4], 200 / 128.0f);
    EXPECT_EQ(values[8 * 4 + 1], 0.5f);
    EXPECT_EQ(values[9 * 4 + 2], 100 / 128.0f);
  }
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

TEST(Picture, WhatItIsItsBytesSay) {
  const TempFolder folder;
  const Bytes bytes = exr(folder);
  EXPECT_EQ(read_picture(folder.write("really_exr.png", {reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
                .values.size(),
            6u * 4);
  expect_error([&] { read_picture(folder.write("text.png", "no picture at all, by any means")); },
               {"text.png", "is not"});
  expect_error([&] { read_picture(folder.write("text.exr", "no picture at all, by any means")); },
               {"text.exr", "is not"});
  expect_error([] { decode_picture({}, "empty"); }, {"empty"});
  expect_error([&] { read_picture(folder.path("none.jpg")); }, {"none.jpg"}, ErrorCode::io);
}

TEST(Picture, ASizeThatOnlyTheHeaderClaimsIsRefusedBeforeAnythingIsAllocated) {
  const auto expect_refused = [](const Bytes& bytes, const std::string& why) {
    expect_error([&] { picture_cost(bytes, "bomb"); }, {"bomb", why});
    expect_error([&] { decode_picture(bytes, "bomb"); }, {"bomb", why});
  };
  expect_refused(png_file(16384, 16384, 8, 2, {}), "16384x16384");
  expect_refused(png_file(8192, 8192, 8, 2, {}), "too short");
  expect_refused(tga_file(16384, 8192, {.kind = 2, .bits = 24}, {}), "too short");
  expect_refused(tga_file(16384, 8192, {.kind = 10, .bits = 24}, Bytes(1000, 255)), "too short");
  expect_refused(hdr_file(16384, 8192, {2, 2, 0x40, 0, 255, 1, 255, 1}), "too short");
  expect_refused(jpeg_of_claimed_size(jpeg(), 65000, 65000), "65000x65000");

  const TempFolder folder;
  Bytes bytes = exr(folder);
  const std::string_view name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const auto found = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
  ASSERT_NE(found, bytes.end());
  const auto set_corner = [&](uint32_t x, uint32_t y) {
    std::memcpy(&*(found + static_cast<std::ptrdiff_t>(name.size()) + 8), &x, sizeof(x));
    std::memcpy(&*(found + static_cast<std::ptrdiff_t>(name.size()) + 12), &y, sizeof(y));
  };
  set_corner(11, 0x7ffffffe);
  expect_refused(bytes, "promises more");
  set_corner(0x7ffffffe, 1);
  expect_refused(bytes, "promises more");
}

TEST(Picture, CutShortItIsWholeOrAnError) {
  const TempFolder folder;
  for (const Bytes& whole : {png(), webp(), jpeg(), progressive_jpeg(5), encoded_hdr(), encoded_tga(), exr(folder)}) {
    const Pixels expected = decode_picture(whole, "whole");
    size_t refused = 0;
    for (size_t size = 0; size < whole.size(); ++size) try {
        const Pixels pixels = decode_picture(std::span(whole).first(size), "cut");
        EXPECT_EQ(pixels.codes, expected.codes) << size << " of " << whole.size();
        EXPECT_EQ(pixels.values, expected.values) << size << " of " << whole.size();
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("cut: "), std::string::npos) << e.what();
        ++refused;
      }
    EXPECT_GE(refused + 20, whole.size()) << "but for what stands behind the last pixel";
  }
}

TEST(Picture, AnyDamageIsAPictureOrAnError) {
  std::mt19937 random(test::seed());
  const TempFolder folder;
  for (const Bytes& whole : {png(), webp(), jpeg(), progressive_jpeg(5), encoded_hdr(), encoded_tga(), exr(folder)})
    for (int round = 0; round < 500; ++round) {
      Bytes bytes = whole;
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
      try {
        const PictureCost cost = picture_cost(bytes, "damaged");
        if (cost.bytes > 1 << 26) continue;
        const Pixels pixels = decode_picture(bytes, "damaged");
        EXPECT_EQ(pixels.codes.size() + pixels.values.size() + pixels.wide_codes.size(),
                  static_cast<size_t>(cost.width) * static_cast<size_t>(cost.height) * 4);
      } catch (const Error&) {
      }
    }
}

}  // namespace
}  // namespace kairos
