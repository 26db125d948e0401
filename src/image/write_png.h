// PNG files, for looking at.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos {

/// The image's R, G and B, sRGB with 8 bits, clamped to what that can show; the other channels are left out. Attributes
/// that are texts become text chunks. Throws Error(io).
void write_png(const Image& image, const std::string& path);

/// The sRGB code, 0 to 255, of a linear value; NaN gives 0.
unsigned char srgb_code(float linear);

}  // namespace kairos
