// PNG files, for looking at.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos {

/// The image's R, G and B, sRGB with 8 bits, clamped to what that can show; the other channels are left out. Attributes
/// that are texts become text chunks. Throws Error(io), and Error(cancelled)
/// where the options say so.
void write_png(const Image& image, const std::string& path, const WriteOptions& options = {});

}  // namespace kairos
