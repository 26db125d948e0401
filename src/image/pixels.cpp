#include "image/pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include <kairos/error.h>

#include "base/file.h"
#include "image/read_exr.h"

namespace kairos {

namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 30;
constexpr int kChannels = 4;

[[noreturn]] void fail(const std::string& place, const std::string& message) {
  throw Error(ErrorCode::bad_input, place, message);
}

/// The decoder's own reason, where it gives one.
std::string reason() {
  const char* text = stbi_failure_reason();
  return text ? std::string(" (") + text + ")" : "";
}

template <class Value>
std::vector<Value> taken(Value* data, const Pixels& size, const std::string& place) {
  const std::unique_ptr<Value, decltype(&std::free)> owner(data, &std::free);
  if (!data) fail(place, "is damaged" + reason());
  const size_t count = static_cast<size_t>(size.width) * static_cast<size_t>(size.height) * kChannels;
  return std::vector<Value>(data, data + count);
}

Pixels read_exr_picture(const std::string& path) {
  const Image image = read_exr(path, kMaxPicturePixels * kChannels * sizeof(float));
  const Channel* grey = image.find("Y");
  const Channel* const channels[kChannels] = {image.find("R") ? image.find("R") : grey,
                                              image.find("G") ? image.find("G") : grey,
                                              image.find("B") ? image.find("B") : grey, image.find("A")};
  if (!channels[0] || !channels[1] || !channels[2]) fail(path, "has no channels R, G and B, nor Y");
  Pixels pixels{image.width, image.height, {}, {}};
  const size_t count = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  pixels.values.assign(count * kChannels, 1.0f);
  for (size_t c = 0; c < kChannels; ++c)
    for (size_t i = 0; channels[c] && i < count; ++i) pixels.values[i * kChannels + c] = channels[c]->values[i];
  return pixels;
}

/// What is not finite becomes zero: one such texel would spread over the whole picture.
void make_finite(std::vector<float>& values) {
  for (float& v : values)
    if (!std::isfinite(v)) v = 0;
}

}  // namespace

Pixels decode_picture(std::span<const uint8_t> bytes, const std::string& place) {
  if (bytes.size() > kMaxFileBytes) fail(place, "is larger than 1 GiB");
  const auto size = static_cast<int>(bytes.size());
  Pixels pixels;
  int channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &pixels.width, &pixels.height, &channels))
    fail(place, "is not a PNG, JPEG, TGA or HDR picture" + reason());
  if (pixels.width < 1 || pixels.height < 1 ||
      static_cast<uint64_t>(pixels.width) * static_cast<uint64_t>(pixels.height) > kMaxPicturePixels)
    fail(place, "says it has " + std::to_string(pixels.width) + "x" + std::to_string(pixels.height) +
                    " pixels; at most " + std::to_string(kMaxPicturePixels) + " are read");
  int width = 0, height = 0;
  if (stbi_is_hdr_from_memory(bytes.data(), size)) {
    pixels.values =
        taken(stbi_loadf_from_memory(bytes.data(), size, &width, &height, &channels, kChannels), pixels, place);
    make_finite(pixels.values);
  } else {
    pixels.codes =
        taken(stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kChannels), pixels, place);
  }
  return pixels;
}

Pixels read_picture(const std::string& path) {
  constexpr std::string_view kExr = ".exr";
  if (path.size() >= kExr.size() && path.compare(path.size() - kExr.size(), kExr.size(), kExr) == 0) {
    Pixels pixels = read_exr_picture(path);
    make_finite(pixels.values);
    return pixels;
  }
  return decode_picture(read_file(path, kMaxFileBytes), path);
}

}  // namespace kairos
