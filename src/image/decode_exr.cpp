// EXR as a picture for surfaces to show: R, G, B, or Y alone, and A.
#include <array>
#include <cstring>

#include <kairos/error.h>

#include "image/picture_formats.h"
#include "image/read_exr.h"

namespace kairos {

namespace {

bool is_exr(std::span<const uint8_t> bytes) {
  constexpr std::array<uint8_t, 4> kSignature{0x76, 0x2f, 0x31, 0x01};
  return bytes.size() >= kSignature.size() && std::memcmp(bytes.data(), kSignature.data(), kSignature.size()) == 0;
}

PictureCost exr_cost(std::span<const uint8_t> bytes, const std::string& place) {
  const ExrSize size = exr_size(bytes, place);
  PictureCost cost = plain_cost(size.width, size.height, kPictureChannels * sizeof(float), place);
  cost.steps *= size.channels;
  cost.bytes += cost.steps * sizeof(float);  // as they are read, before they become pixels
  return cost;
}

Pixels decode_exr(std::span<const uint8_t> bytes, const std::string& place) {
  const PictureCost cost = exr_cost(bytes, place);
  const Image image = read_exr(bytes, place, cost.bytes);
  const Channel* grey = image.find("Y");
  const Channel* const channels[kPictureChannels] = {image.find("R") ? image.find("R") : grey,
                                                     image.find("G") ? image.find("G") : grey,
                                                     image.find("B") ? image.find("B") : grey, image.find("A")};
  if (!channels[0] || !channels[1] || !channels[2])
    throw Error(ErrorCode::bad_input, place, "has no channels R, G and B, nor Y");
  Pixels pixels{image.width, image.height, {}, {}};
  const size_t count = texel_count(cost);
  pixels.values.assign(count * kPictureChannels, 1.0f);
  for (size_t c = 0; c < kPictureChannels; ++c)
    for (size_t i = 0; channels[c] && i < count; ++i) pixels.values[i * kPictureChannels + c] = channels[c]->values[i];
  return pixels;
}

}  // namespace

const PictureFormat kExr{is_exr, exr_cost, decode_exr};

}  // namespace kairos
