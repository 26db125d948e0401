#include "image/pixels.h"

#include <array>
#include <cmath>

#include <kairos/error.h>

#include "base/file.h"
#include "image/picture_formats.h"

namespace kairos {

namespace {

const PictureFormat& format_of(std::span<const uint8_t> bytes, const std::string& place) {
  if (bytes.size() > kMaxPictureFileBytes) throw Error(ErrorCode::bad_input, place, "is larger than 1 GiB");
  if (bytes.empty()) throw Error(ErrorCode::bad_input, place, "is empty");
  // TGA comes last: it has no signature, and is what it is by not being absurd.
  for (const PictureFormat* format : {&kPng, &kJpeg, &kWebp, &kHdr, &kExr, &kTga})
    if (format->is(bytes)) return *format;
  throw Error(ErrorCode::bad_input, place, "is not a PNG, JPEG, WebP, TGA, HDR or EXR picture");
}

}  // namespace

void fail_damaged(const std::string& place, const std::string& why) {
  throw Error(ErrorCode::bad_input, place, "is damaged (" + why + ")");
}

PictureCost plain_cost(int64_t width, int64_t height, uint64_t bytes_per_texel, const std::string& place) {
  constexpr int64_t kMostSide = 1 << 30;
  if (width < 1 || height < 1) fail_damaged(place, "no pixels");
  if (width > kMostSide || height > kMostSide ||
      static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > kMaxPicturePixels)
    throw Error(ErrorCode::bad_input, place,
                "says it has " + std::to_string(width) + "x" + std::to_string(height) + " pixels; at most " +
                    std::to_string(kMaxPicturePixels) + " are read");
  const uint64_t texels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  return {static_cast<int>(width), static_cast<int>(height), texels * bytes_per_texel, texels};
}

PictureCost picture_cost(std::span<const uint8_t> bytes, const std::string& place) {
  return format_of(bytes, place).cost(bytes, place);
}

Pixels decode_picture(std::span<const uint8_t> bytes, const std::string& place) {
  Pixels pixels = format_of(bytes, place).decode(bytes, place);
  // One such texel would spread over the whole picture.
  for (float& value : pixels.values)
    if (!std::isfinite(value)) value = 0;
  return pixels;
}

Pixels read_picture(const std::string& path) { return decode_picture(read_file(path, kMaxPictureFileBytes), path); }

}  // namespace kairos
