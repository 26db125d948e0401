// From a ray's visibility segments to segments with colours: shared by the integrators that trace time-continuous rays.
#pragma once

#include <span>
#include <vector>

#include "integrators/integrator.h"
#include "integrators/layer_shading.h"
#include "integrators/spread.h"
#include "math/hash.h"

namespace kairos {

/// One thread's scratch memory.
class SegmentShading {
 public:
  /// samples: per ray, see spread_samples.
  SegmentShading(const PixelContext& context, int samples)
      : context_(context), samples_per_ray_(samples), layers_(context) {}

  /// Appends the shaded parts of the segments of ray `index` of a pixel, seen through `veils`, to `out`. phase: see
  /// spread_samples.
  void shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> veils, uint64_t pixel_seed,
             uint32_t index, float phase, std::vector<ShadedSegment>& out) {
    if (pixel_seed != key_.seed) key_ = {pixel_seed, 0};
    const double share = unit_float(hash(pixel_seed, index, kShareDimension));
    if (!veils.empty() || context_.shader.has_sky()) {
      evaluations_ += layers_.shade(ray, segments, veils, samples_per_ray_, share, phase, key_, out);
      return;
    }
    spread_samples(
        segments, samples_per_ray_, share, phase, [&](const Segment& s) { return context_.shader.varies(s.mesh); },
        samples_);
    for (const ShadingSample& sample : samples_) out.push_back(shade_one(ray, segments[sample.segment], sample));
    evaluations_ += samples_.size();
  }

  uint64_t evaluations() const { return evaluations_; }

 private:
  static constexpr uint64_t kShareDimension = 3;  // beside x, y and time

  ShadedSegment shade_one(const Ray& ray, const Segment& segment, const ShadingSample& sample) {
    const Shade shade = context_.shader.shade(ray, segment.mesh, segment.triangle, sample.time, key_);
    ++key_.index;
    const auto dist_at = [&](float time) {
      return segment.dist_begin +
             (segment.dist_end - segment.dist_begin) * ((time - segment.begin) / segment.duration());
    };
    return {sample.begin, sample.end,   dist_at(sample.begin), dist_at(sample.end), shade.colour,
            shade.normal, shade.albedo, segment.mesh,          segment.triangle};
  }

  const PixelContext& context_;
  int samples_per_ray_;
  LayerShading layers_;
  std::vector<ShadingSample> samples_;
  SampleKey key_;  // of the next shading sample: numbered through each pixel
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
