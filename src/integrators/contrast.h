// How differently the samples of a pixel look. docs/method.md, "Samples where they are needed".
#pragma once

#include <algorithm>
#include <span>

#include "pixel/record_builder.h"

namespace kairos {

/// How differently the rays of a pixel look, as a display shows them: colours above 1 count as 1.
class Contrast {
 public:
  explicit Contrast(Vec3f background) : background_(background) {}

  void begin_pixel() {
    low_ = {1, 1, 1};
    high_ = {0, 0, 0};
  }

  /// Of rays of one instant, those from number `first` on.
  void add(const RecordBuilder& record, size_t first) { add(record, record.rays().subspan(first)); }
  void add(const RecordBuilder& record, std::span<const PixelRay> rays) {
    for (const PixelRay& ray : rays) {
      if (ray.parts == 0)
        add(background_);
      else
        add(record.knots()[record.parts()[ray.first_part].first_knot].colour);
    }
  }

  void add(const Vec3f& colour) {
    for (int i = 0; i < 3; ++i) {
      const float shown = std::clamp(colour[i], 0.0f, 1.0f);
      low_[i] = std::min(low_[i], shown);
      high_[i] = std::max(high_[i], shown);
    }
  }

  /// The sum over red, green and blue of (largest - smallest)^2; 0 to 3.
  double square() const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double range = std::max(0.0, static_cast<double>(high_[i]) - static_cast<double>(low_[i]));
      sum += range * range;
    }
    return sum;
  }

 private:
  Vec3f background_;
  Vec3f low_{1, 1, 1}, high_{};
};

}  // namespace kairos
