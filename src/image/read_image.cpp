#include <kairos/error.h>
#include <kairos/image.h>

#include "base/file.h"
#include "image/picture_formats.h"
#include "image/read_exr.h"
#include "image/srgb.h"

namespace kairos {

namespace {

constexpr size_t kChannels = 4;
constexpr float kMostCode = 255, kMostWideCode = 65535;

}  // namespace

Image read_image(const std::string& path, uint64_t byte_limit) {
  const std::vector<uint8_t> bytes = read_file(path, byte_limit);
  if (kExr.is(bytes)) return read_exr(bytes, path, byte_limit);
  const PictureCost cost = picture_cost(bytes, path);
  const size_t count = static_cast<size_t>(cost.width) * static_cast<size_t>(cost.height);
  if (count > byte_limit / (kChannels * sizeof(float)))
    throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(byte_limit) + " bytes");
  const Pixels pixels = decode_picture(bytes, path);
  Image image;
  image.width = image.frame_width = pixels.width;
  image.height = image.frame_height = pixels.height;
  const char* const names[kChannels] = {"R", "G", "B", "A"};
  for (size_t c = 0; c < kChannels; ++c) {
    Channel channel{names[c], Channel::Storage::colour, std::vector<float>(count)};
    for (size_t i = 0; i < count; ++i) {
      const size_t at = i * kChannels + c;
      if (!pixels.values.empty()) {
        channel.values[i] = pixels.values[at];
        continue;
      }
      const float code = pixels.codes.empty() ? static_cast<float>(pixels.wide_codes[at]) / kMostWideCode
                                              : static_cast<float>(pixels.codes[at]) / kMostCode;
      channel.values[i] = c < 3 ? srgb_value(code) : code;
    }
    image.channels.push_back(std::move(channel));
  }
  return image;
}

}  // namespace kairos
