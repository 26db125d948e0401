// A picture over time with fewer pixels.
#pragma once

#include <functional>
#include <vector>

#include <kairos/time_picture.h>

#include "film/time_tile.h"

namespace kairos::time_page {

struct ReducedPicture {
  int width = 0, height = 0;
  std::vector<TimeTile> rows;  ///< [row]: of `width` pixels
};

/// Each pixel the mean over factor x factor of them at each instant, or fewer at the right and lower edge; pixels that
/// are not there count as black. tolerance: TimeQuality's. progress: as render's.
ReducedPicture reduced(const TimePicture& picture, int factor, double tolerance, int threads,
                       const std::function<bool(double)>& progress);

}  // namespace kairos::time_page
