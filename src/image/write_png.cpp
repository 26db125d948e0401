#include "image/write_png.h"

#include <cmath>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "image/encode.h"

namespace kairos {

unsigned char srgb_code(float linear) {  // IEC 61966-2-1
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<unsigned char>(std::lround(encoded * 255));
}

void write_png(const Image& image, const std::string& path) {
  const Channel* const colour[3] = {image.find("R"), image.find("G"), image.find("B")};
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  constexpr size_t kMostPixels = size_t{1} << 29;  // the encoder counts its bytes in 31 bits
  if (pixels > kMostPixels) throw Error(ErrorCode::io, path, "is too large for PNG; write EXR");
  std::vector<unsigned char> bytes(pixels * 3);
  for (size_t i = 0; i < 3; ++i)
    for (size_t pixel = 0; pixel < pixels; ++pixel)
      if (colour[i] != nullptr) bytes[pixel * 3 + i] = srgb_code(colour[i]->values[pixel]);
  const std::vector<uint8_t> encoded = encode_png(bytes, image.width, image.height, 3, path);
  AtomicFile file(path);
  file.write(encoded.data(), encoded.size());
  file.commit();
}

}  // namespace kairos
