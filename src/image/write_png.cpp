#include "image/write_png.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "image/encode.h"
#include "image/srgb.h"
#include "image/view_transform.h"

namespace kairos {

namespace {

/// Those of the attributes that are texts in ASCII.
std::vector<PngText> texts_of(const Image& image) {
  constexpr size_t kLongestName = 79;
  std::vector<PngText> texts;
  for (const Attribute& attribute : image.attributes) {
    const auto* const text = std::get_if<std::string>(&attribute.value);
    const auto is_plain = [](char c) { return c >= ' ' && c <= '~'; };
    if (text == nullptr || attribute.name.empty() || attribute.name.size() > kLongestName ||
        !std::all_of(text->begin(), text->end(), is_plain))
      continue;
    texts.push_back({attribute.name, *text});
  }
  return texts;
}

}  // namespace

std::vector<uint8_t> screen_codes(const Image& image, const WriteOptions& options, size_t channels) {
  const Channel* const colour[3] = {image.find("R"), image.find("G"), image.find("B")};
  const Channel* const alphas = image.find("A");
  std::vector<uint8_t> codes(static_cast<size_t>(image.width) * static_cast<size_t>(image.height) * channels);
  for (size_t pixel = 0; pixel * channels < codes.size(); ++pixel) {
    uint8_t* const code = &codes[pixel * channels];
    Vec3f linear;
    for (size_t i = 0; i < 3; ++i)
      if (colour[i] != nullptr) linear[static_cast<int>(i)] = colour[i]->values[pixel];
    if (alphas != nullptr) {
      const float alpha = alphas->values[pixel] > 0 ? std::min(alphas->values[pixel], 1.0f) : 0;
      code[3] = static_cast<uint8_t>(std::lround(alpha * 255));
      linear = code[3] == 0 ? Vec3f{} : linear / alpha;
    }
    const Vec3f seen = seen_on_screen(linear, options.view, options.exposure);
    for (size_t i = 0; i < 3; ++i) code[i] = srgb_code(seen[static_cast<int>(i)]);
  }
  return codes;
}

void write_png(const Image& image, const std::string& path, const WriteOptions& options) {
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  constexpr size_t kMostPixels = size_t{1} << 29;
  if (pixels > kMostPixels) throw Error(ErrorCode::io, path, "is too large for PNG; write EXR");
  const size_t channels = image.find("A") != nullptr ? 4 : 3;
  const std::vector<uint8_t> bytes = screen_codes(image, options, channels);
  const std::vector<uint8_t> encoded =
      encode_png(bytes, image.width, image.height, static_cast<int>(channels), path, texts_of(image));
  if (options.go_on && !options.go_on()) throw Error(ErrorCode::cancelled, path, "is not written: stopped");
  AtomicFile file(path);
  file.write(encoded.data(), encoded.size());
  file.commit();
}

}  // namespace kairos
