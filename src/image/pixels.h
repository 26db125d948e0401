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

/// PNG, JPEG, TGA, HDR (Radiance), as the bytes say. Nothing is allocated before the header's size is known to be sane.
/// Throws Error(bad_input, place).
Pixels decode_picture(std::span<const uint8_t> bytes, const std::string& place);

/// The same from a file, which may also be OpenEXR (channels R, G, B, or Y alone, and A). Throws Error(io) or
/// Error(bad_input).
Pixels read_picture(const std::string& path);

}  // namespace kairos
