#include "image/encode.h"

#include <kairos/error.h>

namespace kairos {

void check_code_count(std::span<const uint8_t> codes, int width, int height, int channels, const std::string& place) {
  constexpr size_t kMostPixels = size_t{1} << 29;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (width < 1 || height < 1 || pixels > kMostPixels || codes.size() != pixels * static_cast<size_t>(channels))
    throw Error(ErrorCode::io, place, "is too large for PNG or JPEG; write EXR");
}

}  // namespace kairos
