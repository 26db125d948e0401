#include "image/write_png.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "image/encode.h"
#include "image/srgb.h"

namespace kairos {

namespace {

/// The check sum of PNG's chunks.
uint32_t crc32(std::span<const uint8_t> bytes) {
  uint32_t crc = 0xffffffff;
  for (const uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc;
}

void append_number(std::vector<uint8_t>& bytes, uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(number >> shift));
}

/// Chunks with those of the attributes that are texts, as Latin-1 has them.
std::vector<uint8_t> text_chunks(const Image& image) {
  constexpr size_t kLongestName = 79;
  std::vector<uint8_t> chunks;
  for (const Attribute& attribute : image.attributes) {
    const auto* const text = std::get_if<std::string>(&attribute.value);
    const auto is_plain = [](char c) { return c >= ' ' && c <= '~'; };
    if (text == nullptr || attribute.name.size() > kLongestName || !std::all_of(text->begin(), text->end(), is_plain))
      continue;
    const std::string chunk = "tEXt" + attribute.name + '\0' + *text;
    append_number(chunks, static_cast<uint32_t>(chunk.size() - 4));
    const size_t begin = chunks.size();
    chunks.insert(chunks.end(), chunk.begin(), chunk.end());
    append_number(chunks, crc32(std::span(chunks).subspan(begin)));
  }
  return chunks;
}

}  // namespace

void write_png(const Image& image, const std::string& path, const WriteOptions& options) {
  const Channel* const colour[3] = {image.find("R"), image.find("G"), image.find("B")};
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  constexpr size_t kMostPixels = size_t{1} << 29;  // the encoder counts its bytes in 31 bits
  if (pixels > kMostPixels) throw Error(ErrorCode::io, path, "is too large for PNG; write EXR");
  std::vector<unsigned char> bytes(pixels * 3);
  for (size_t i = 0; i < 3; ++i)
    for (size_t pixel = 0; pixel < pixels; ++pixel)
      if (colour[i] != nullptr) bytes[pixel * 3 + i] = srgb_code(colour[i]->values[pixel]);
  const std::vector<uint8_t> texts = text_chunks(image),
                             encoded = encode_png(bytes, image.width, image.height, 3, path);
  if (options.go_on && !options.go_on()) throw Error(ErrorCode::cancelled, path, "is not written: stopped");
  AtomicFile file(path);
  constexpr size_t kHead = 8 + 25;  // signature and header chunk
  file.write(encoded.data(), kHead);
  file.write(texts.data(), texts.size());
  file.write(encoded.data() + kHead, encoded.size() - kHead);
  file.commit();
}

}  // namespace kairos
