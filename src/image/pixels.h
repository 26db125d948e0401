// A decoded picture.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kairos {

/// Rows from the top, four values per pixel: red, green, blue, alpha. One of the two lists is empty.
struct Pixels {
  int width = 0, height = 0;
  std::vector<uint8_t> codes;  ///< 0 to 255, as formats of 8 bits hold them: usually sRGB
  std::vector<float> values;   ///< linear
};

/// The most pixels that a picture may have: 16384 x 8192.
inline constexpr uint64_t kMaxPicturePixels = uint64_t{1} << 27;

/// PNG, JPEG, TGA, HDR (Radiance), as the bytes say. Nothing is allocated before the header's size is known to be sane.
/// Throws Error(bad_input, place).
Pixels decode_picture(std::span<const uint8_t> bytes, const std::string& place);

/// The same from a file, which may also be OpenEXR (channels R, G, B, or Y alone, and A). Throws Error(io) or
/// Error(bad_input).
Pixels read_picture(const std::string& path);

}  // namespace kairos
