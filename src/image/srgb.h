// The curve of sRGB, IEC 61966-2-1.
#pragma once

#include <cmath>

namespace kairos {

/// The linear value of a code from 0 to 1.
inline float srgb_value(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

/// The code, 0 to 255, of a linear value; NaN gives 0.
inline unsigned char srgb_code(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<unsigned char>(std::lround(encoded * 255));
}

}  // namespace kairos
