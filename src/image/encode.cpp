#include "image/encode.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include <kairos/error.h>

namespace kairos {

namespace {

void append(void* context, void* data, int size) {
  auto& out = *static_cast<std::vector<uint8_t>*>(context);
  auto* const begin = static_cast<uint8_t*>(data);
  out.insert(out.end(), begin, begin + size);
}

void check_size(std::span<const uint8_t> codes, int width, int height, int channels, const std::string& place) {
  constexpr size_t kMostPixels = size_t{1} << 29;  // the encoders count their bytes in 31 bits
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (pixels > kMostPixels || codes.size() != pixels * static_cast<size_t>(channels))
    throw Error(ErrorCode::io, place, "is too large for PNG or JPEG; write EXR");
}

}  // namespace

std::vector<uint8_t> encode_png(std::span<const uint8_t> codes, int width, int height, int channels,
                                const std::string& place) {
  check_size(codes, width, height, channels, place);
  std::vector<uint8_t> encoded;
  if (stbi_write_png_to_func(append, &encoded, width, height, channels, codes.data(), width * channels) == 0)
    throw Error(ErrorCode::io, place, "cannot be encoded as PNG");
  return encoded;
}

std::vector<uint8_t> encode_jpeg(std::span<const uint8_t> codes, int width, int height, int channels, int quality,
                                 const std::string& place) {
  check_size(codes, width, height, channels, place);
  std::vector<uint8_t> encoded;
  if (stbi_write_jpg_to_func(append, &encoded, width, height, channels, codes.data(), quality) == 0)
    throw Error(ErrorCode::io, place, "cannot be encoded as JPEG");
  return encoded;
}

}  // namespace kairos
