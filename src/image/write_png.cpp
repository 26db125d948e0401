#include "image/write_png.h"

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "image/encode.h"
#include "image/srgb.h"

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

void write_png(const Image& image, const std::string& path, const WriteOptions& options) {
  const Channel* const colour[3] = {image.find("R"), image.find("G"), image.find("B")};
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  constexpr size_t kMostPixels = size_t{1} << 29;
  if (pixels > kMostPixels) throw Error(ErrorCode::io, path, "is too large for PNG; write EXR");
  std::vector<unsigned char> bytes(pixels * 3);
  for (size_t i = 0; i < 3; ++i)
    for (size_t pixel = 0; pixel < pixels; ++pixel)
      if (colour[i] != nullptr) bytes[pixel * 3 + i] = srgb_code(colour[i]->values[pixel]);
  const std::vector<uint8_t> encoded = encode_png(bytes, image.width, image.height, 3, path, texts_of(image));
  if (options.go_on && !options.go_on()) throw Error(ErrorCode::cancelled, path, "is not written: stopped");
  AtomicFile file(path);
  file.write(encoded.data(), encoded.size());
  file.commit();
}

}  // namespace kairos
