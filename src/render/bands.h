// Pictures are rendered in bands, so that what is known of each pixel beforehand takes little memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <kairos/render.h>

namespace kairos {

/// Of the motion mask that is 24 bytes each.
inline constexpr int64_t kBandPixels = int64_t{1} << 23;

/// Whole rows of a crop, from the top, of about kBandPixels each: all but huge pictures are one.
inline std::vector<Crop> bands_of(const Crop& crop) {
  constexpr int kLeastRows = 128;
  const int rows = static_cast<int>(std::max<int64_t>(kLeastRows, kBandPixels / (crop.x1 - crop.x0)));
  std::vector<Crop> bands;
  for (int y = crop.y0; y < crop.y1; y += rows)
    bands.push_back({crop.x0, crop.x1, y, static_cast<int>(std::min<int64_t>(crop.y1, int64_t{y} + rows))});
  return bands;
}

}  // namespace kairos
