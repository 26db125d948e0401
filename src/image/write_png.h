// PNG files, for looking at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <kairos/image.h>

namespace kairos {

/// The image's R, G and B, sRGB with 8 bits, clamped to what that can show; the other channels are left out. Attributes
/// that are texts become text chunks. Throws Error(io), and Error(cancelled)
/// where the options say so.
void write_png(const Image& image, const std::string& path, const WriteOptions& options = {});

/// The codes that a PNG of it holds, row by row from the top, `channels` for each pixel: red, green and blue, and the
/// fourth for alpha, by which the colours are divided.
std::vector<uint8_t> screen_codes(const Image& image, const WriteOptions& options, size_t channels);

}  // namespace kairos
