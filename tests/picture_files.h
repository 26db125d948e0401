// Bytes of picture files that the project itself does not write: every kind of PNG, progressive JPEG, TGA, HDR.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "image/encode.h"

namespace kairos {

using Bytes = std::vector<uint8_t>;

inline void append(Bytes& to, std::string_view text) { to.insert(to.end(), text.begin(), text.end()); }
inline void append(Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }
inline void append_big(Bytes& to, uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<uint8_t>(word >> shift));
}

inline void append_chunk(Bytes& png, std::string_view name, const Bytes& content) {
  append_big(png, static_cast<uint32_t>(content.size()));
  Bytes chunk;
  append(chunk, name);
  append(chunk, content);
  append(png, chunk);
  append_big(png, static_cast<uint32_t>(crc32(0, chunk.data(), static_cast<uInt>(chunk.size()))));
}

/// kind: PNG's colour type. rows: each with the byte of its filter before it.
inline Bytes png_file(uint32_t width, uint32_t height, uint8_t bits, uint8_t kind, const Bytes& rows,
                      const Bytes& palette = {}, const Bytes& alphas = {}) {
  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header;
  append_big(header, width);
  append_big(header, height);
  for (const uint8_t byte : {bits, kind, uint8_t{0}, uint8_t{0}, uint8_t{0}}) header.push_back(byte);
  append_chunk(png, "IHDR", header);
  if (!palette.empty()) append_chunk(png, "PLTE", palette);
  if (!alphas.empty()) append_chunk(png, "tRNS", alphas);
  uLongf size = compressBound(rows.size());
  Bytes packed(size);
  compress(packed.data(), &size, rows.data(), rows.size());
  packed.resize(size);
  append_chunk(png, "IDAT", packed);
  append_chunk(png, "IEND", {});
  return png;
}

struct TgaKind {
  uint8_t kind = 2, bits = 24, flags = 0;
  uint8_t palette_entries = 0, palette_bits = 0;
};

/// rest: the palette, then the texels.
inline Bytes tga_file(uint16_t width, uint16_t height, const TgaKind& kind, const Bytes& rest) {
  Bytes tga{0,         static_cast<uint8_t>(kind.palette_entries > 0),
            kind.kind, 0,
            0,         kind.palette_entries,
            0,         kind.palette_bits,
            0,         0,
            0,         0};
  for (const uint16_t word : {width, height}) {
    tga.push_back(static_cast<uint8_t>(word));
    tga.push_back(static_cast<uint8_t>(word >> 8));
  }
  tga.push_back(kind.bits);
  tga.push_back(kind.flags);
  append(tga, rest);
  return tga;
}

inline Bytes hdr_file(int width, int height, const Bytes& rest) {
  Bytes hdr;
  append(hdr,
         "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n");
  append(hdr, rest);
  return hdr;
}

/// A JPEG whose header says another size: what follows is not enough for it.
inline Bytes jpeg_of_claimed_size(Bytes jpeg, uint16_t width, uint16_t height) {
  for (size_t i = 0; i + 8 < jpeg.size(); ++i)
    if (jpeg[i] == 0xff && (jpeg[i + 1] == 0xc0 || jpeg[i + 1] == 0xc2)) {
      jpeg[i + 5] = static_cast<uint8_t>(height >> 8);
      jpeg[i + 6] = static_cast<uint8_t>(height);
      jpeg[i + 7] = static_cast<uint8_t>(width >> 8);
      jpeg[i + 8] = static_cast<uint8_t>(width);
      break;
    }
  return jpeg;
}

/// Progressive, grey, one block, whose first scan comes `scans` times.
inline Bytes progressive_jpeg(int scans) {
  const Bytes baseline = encode_jpeg(Bytes(64, 77), 8, 8, 1, 95, "test");
  Bytes jpeg;
  size_t scan = 0;
  for (size_t i = 0; i + 1 < baseline.size() && scan == 0; ++i)
    if (baseline[i] == 0xff && baseline[i + 1] == 0xda) scan = i;
  jpeg.assign(baseline.begin(), baseline.begin() + static_cast<std::ptrdiff_t>(scan));
  for (size_t i = 0; i + 1 < jpeg.size(); ++i)
    if (jpeg[i] == 0xff && jpeg[i + 1] == 0xc0) jpeg[i + 1] = 0xc2;
  // The mean of each block alone, then its last bit again and again.
  const Bytes begin{0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0x01}, end{0xff, 0xd9};
  append(jpeg, begin);
  append(jpeg, Bytes{0x3f});  // no difference from 0, in the code that all encoders use; filled with ones
  for (int i = 1; i < scans; ++i) {
    append(jpeg, Bytes{0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0x10});
    append(jpeg, Bytes{0x7f});
  }
  append(jpeg, end);
  return jpeg;
}

}  // namespace kairos
