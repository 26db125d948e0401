// One reader for each format of pictures. None believes a header further than the bytes behind it bear out.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <kairos/image.h>

#include "image/pixels.h"

namespace kairos {

/// Each format: whether the bytes begin as it does; what decoding will take, by headers alone; the picture. The last
/// two throw Error(bad_input, place) for what is damaged or cut short. All rows and columns are there, or none.
struct PictureFormat {
  bool (*is)(std::span<const uint8_t> bytes);
  PictureCost (*cost)(std::span<const uint8_t> bytes, const std::string& place);
  Pixels (*decode)(std::span<const uint8_t> bytes, const std::string& place);
};

extern const PictureFormat kPng, kJpeg, kWebp, kHdr, kTga, kExr;

/// Throws Error(bad_input, place, "is damaged (why)").
[[noreturn]] void fail_damaged(const std::string& place, const std::string& why);

/// Values per pixel of what is decoded.
inline constexpr size_t kPictureChannels = 4;

/// The cost of a picture that takes one pass and nothing besides itself. bytes_per_texel: of Pixels. Throws
/// Error(bad_input, place) for a size that no picture has.
PictureCost plain_cost(int64_t width, int64_t height, uint64_t bytes_per_texel, const std::string& place);

inline size_t texel_count(const PictureCost& cost) {
  return static_cast<size_t>(cost.width) * static_cast<size_t>(cost.height);
}

}  // namespace kairos
