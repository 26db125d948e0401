// From a ray's visibility segments to parts with colours: shared by the integrators that trace time-continuous rays.
#pragma once

#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/layer_shading.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// Of a segment the part from `begin` to `end`, with one knot.
inline SeenPart part_of(const Segment& segment, float begin, float end, uint32_t knot) {
  return {{begin, end, distance_at(segment, begin), distance_at(segment, end), segment.mesh, segment.triangle,
           segment.front},
          knot};
}

/// One thread's scratch memory.
class SegmentShading {
 public:
  SegmentShading(const Shader& shader, ShadingOptions options) : shader_(shader), options_(options), layers_(shader) {}

  /// Appends the parts of the segments of ray `index` of a pixel, seen through `blended`, to `out`: they cover exactly
  /// what the segments cover, and each is part of one of them. phase: see spread_samples.
  void shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended, uint64_t pixel_seed,
             uint32_t index, float phase, RecordBuilder& out) {
    if (pixel_seed != key_.seed) key_ = {pixel_seed, 0};
    const double share = unit_float(hash(pixel_seed, index, kShareDimension));
    if (!blended.empty() || shader_.has_sky()) {
      evaluations_ += layers_.shade(ray, segments, blended, options_, share, phase, key_, out);
      return;
    }
    spread_samples(
        segments, options_.samples, share, phase,
        [&](const Segment& first, const Segment& second) {
          return options_.clusters == Clusters::on && shader_.joined(first, second);
        },
        [&](const Segment& s) { return shader_.varies(s.mesh); }, samples_);
    for (const ShadingSample& sample : samples_) {
      const Segment& seen = segments[sample.segment];
      const Shade shade = shader_.shade(ray, seen.mesh, seen.triangle, sample.time, key_);
      ++key_.index;
      const uint32_t knot = out.add_knot(sample.time, shade.colour, shade.normal, shade.albedo);
      for (size_t i = sample.first; i < segments.size() && segments[i].begin < sample.end; ++i)
        out.add_part(part_of(segments[i], std::max(segments[i].begin, sample.begin),
                             std::min(segments[i].end, sample.end), knot));
    }
    evaluations_ += samples_.size();
  }

  uint64_t evaluations() const { return evaluations_; }

 private:
  static constexpr uint64_t kShareDimension = 3;  // beside x, y and time

  const Shader& shader_;
  ShadingOptions options_;
  LayerShading layers_;
  std::vector<ShadingSample> samples_;
  SampleKey key_;  // of the next shading sample: numbered through each pixel
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
