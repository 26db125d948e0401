// Pictures of 8-bit codes as bytes of a file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kairos {

/// What a PNG says about itself; both in ASCII, the name of 1 to 79 characters.
struct PngText {
  std::string name, text;
};

/// codes: rows from the top, `channels` codes per pixel (1: grey, 3: red, green, blue; PNG 4: alpha, too). `place`
/// names the picture in messages. Throw Error(io) for sizes that the format cannot have.
std::vector<uint8_t> encode_png(std::span<const uint8_t> codes, int width, int height, int channels,
                                const std::string& place, const std::vector<PngText>& texts = {});
/// Codes of 16 bits each, as big-endian bytes.
std::vector<uint8_t> encode_png16(std::span<const uint8_t> codes, int width, int height, int channels,
                                  const std::string& place);
/// quality: 1 to 100; above 90 colour is kept at full resolution.
std::vector<uint8_t> encode_jpeg(std::span<const uint8_t> codes, int width, int height, int channels, int quality,
                                 const std::string& place);

/// Throws Error(io, place) unless there are as many codes as the size says, and not too many.
void check_code_count(std::span<const uint8_t> codes, int width, int height, int channels, const std::string& place);

}  // namespace kairos
