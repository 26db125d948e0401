// WebP, by libwebp: still pictures, with losses and without.
#include <cstring>

#include <webp/decode.h>

#include <kairos/error.h>

#include "image/picture_formats.h"

namespace kairos {

namespace {

bool is_webp(std::span<const uint8_t> bytes) {
  constexpr size_t kSignature = 12;
  return bytes.size() >= kSignature && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

PictureCost webp_cost(std::span<const uint8_t> bytes, const std::string& place) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
    fail_damaged(place, "no sound WebP header");
  if (features.has_animation != 0) throw Error(ErrorCode::bad_input, place, "is an animated WebP; give a still one");
  // The decoder of pictures without losses holds all of them a second time.
  return plain_cost(features.width, features.height, 2 * kPictureChannels, place);
}

Pixels decode_webp(std::span<const uint8_t> bytes, const std::string& place) {
  const PictureCost cost = webp_cost(bytes, place);
  Pixels pixels{cost.width, cost.height, std::vector<uint8_t>(texel_count(cost) * kPictureChannels), {}};
  const int stride = cost.width * static_cast<int>(kPictureChannels);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), pixels.codes.data(), pixels.codes.size(), stride) == nullptr)
    fail_damaged(place, "no sound WebP data, or cut short");
  return pixels;
}

}  // namespace

const PictureFormat kWebp{is_webp, webp_cost, decode_webp};

}  // namespace kairos
