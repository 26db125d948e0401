// Pictures of 8-bit codes as bytes of a file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kairos {

/// codes: rows from the top, `channels` (1: grey, 3: red, green, blue) codes per pixel. `place` names the picture in
/// messages. Throw Error(io) for more pixels than the encoder can count.
std::vector<uint8_t> encode_png(std::span<const uint8_t> codes, int width, int height, int channels,
                                const std::string& place);
/// quality: 1 to 100; above 90 colour is kept at full resolution.
std::vector<uint8_t> encode_jpeg(std::span<const uint8_t> codes, int width, int height, int channels, int quality,
                                 const std::string& place);

}  // namespace kairos
