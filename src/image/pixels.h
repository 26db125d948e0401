// Pictures from their files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <kairos/image.h>

namespace kairos {

/// The most pixels that a picture may have: 16384 x 8192.
inline constexpr uint64_t kMaxPicturePixels = uint64_t{1} << 27;
/// The largest file that is read.
inline constexpr uint64_t kMaxPictureFileBytes = uint64_t{1} << 30;

/// What decoding a picture takes, known from its headers before anything of its size is allocated.
struct PictureCost {
  int width = 0, height = 0;
  uint64_t bytes = 0;  ///< of memory: the decoded picture, and what its decoder needs beside it
  uint64_t steps = 0;  ///< texels decoded, each as often as the file has passes over it
};

/// PNG, JPEG, WebP, TGA, HDR (Radiance) or OpenEXR (channels R, G, B, or Y alone, and A), as the bytes say. Throws
/// Error(bad_input, place) for what is none of them, or larger than kMaxPicturePixels.
PictureCost picture_cost(std::span<const uint8_t> bytes, const std::string& place);

/// The picture; what is not finite is zero. Throws Error(bad_input, place) as above, and for a damaged one.
Pixels decode_picture(std::span<const uint8_t> bytes, const std::string& place);

/// The same from a file. Throws Error(io) or Error(bad_input).
Pixels read_picture(const std::string& path);

}  // namespace kairos
