// How differently the samples of a pixel look. docs/method.md, "Samples where they are needed".
#pragma once

#include <algorithm>

#include "pixel/shaded_segment.h"

namespace kairos {

/// How differently the rays of a pixel look, as a display shows them: colours above 1 count as 1. Hands on to another
/// sink, if there is one.
class ContrastSink : public RaySink {
 public:
  explicit ContrastSink(Vec3f background) : background_(background) {}

  void begin_pixel(RaySink* next) {
    next_ = next;
    low_ = {1, 1, 1};
    high_ = {0, 0, 0};
  }

  /// Of discrete rays.
  void add(const ShadedRay& ray) override {
    const Vec3f& colour = ray.segments.empty() ? background_ : ray.segments.front().colour;
    for (int i = 0; i < 3; ++i) {
      const float shown = std::clamp(colour[i], 0.0f, 1.0f);
      low_[i] = std::min(low_[i], shown);
      high_[i] = std::max(high_[i], shown);
    }
    if (next_ != nullptr) next_->add(ray);
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
  RaySink* next_ = nullptr;
  Vec3f low_, high_;
};

}  // namespace kairos
