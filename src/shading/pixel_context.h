// What a pixel's rays are made from and shaded with.
#pragma once

#include <kairos/record.h>
#include <kairos/shutter.h>
#include <kairos/tracer.h>

#include "camera/camera_rays.h"
#include "camera/pixel_filter.h"
#include "camera/pixel_times.h"
#include "math/sampler.h"
#include "shading/shader.h"

namespace kairos {

/// The same for all pixels. Immutable, shared by all threads.
struct PixelContext {
  CameraRays camera;
  Sampler sampler;
  PixelFilter filter;
  const Shader& shader;
  Vec3f background{};
  RecordNeeds needs{};
  std::optional<Exposure> exposure{};

  /// When pixel (x, y) looks.
  PixelTimes times(int x, int y) const { return exposure ? PixelTimes(exposure->weight(x, y)) : PixelTimes(); }

  /// Where in the pixel a sample lies, as PixelRay::film.
  Vec2f film(const SamplePoint& point) const {
    return {static_cast<float>(0.5 + filter.offset(point.x)), static_cast<float>(0.5 + filter.offset(point.y))};
  }
  /// The ray of a sample of pixel (x, y).
  Ray ray(int x, int y, const SamplePoint& point) const {
    return camera.at(x + 0.5 + filter.offset(point.x), y + 0.5 + filter.offset(point.y));
  }
};

}  // namespace kairos
