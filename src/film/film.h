// Where finished pixels are put: the channels of an image, one plane each.
#pragma once

#include <vector>

#include <kairos/render.h>

#include "film/pixel_sum.h"

namespace kairos {

/// Different pixels may be set from different threads at once.
class Film {
 public:
  /// frame: of the projection; crop: inside of it. Throws Error(bad_usage) for an AOV named twice.
  Film(int frame_width, int frame_height, const Crop& crop, const std::vector<Aov>& aovs);

  /// x, y: in the full frame, inside the crop.
  void set(int x, int y, const PixelSum& sum);

  /// The finished image. Leaves the film empty.
  Image take() { return std::move(image_); }

 private:
  std::vector<Aov> aovs_;
  Image image_;
};

}  // namespace kairos
