// From a ray's visibility segments to parts with colours: shared by the integrators that trace time-continuous rays.
#pragma once

#include <algorithm>
#include <cmath>
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
  SegmentShading(const Shader& shader, const ShadingOptions& options)
      : shader_(shader), options_(options), layers_(shader), keys_(options.grid) {}

  /// Appends the parts of the segments of ray `index` of a pixel, seen through `blended`, to `out`: they cover exactly
  /// what the segments cover, and each is part of one of them. phase: see spread_samples.
  /// window: that of the rays.
  void shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended,
             const TimeRange& window, uint64_t pixel_seed, uint32_t index, float phase, RecordBuilder& out) {
    keys_.begin_ray(pixel_seed, index);
    const double share = unit_float(hash(pixel_seed, index, kShareDimension));
    if (!blended.empty() || shader_.has_sky()) {
      evaluations_ += layers_.shade(ray, segments, blended, window, options_, share, phase, keys_, out);
      return;
    }
    if (options_.over_time) {
      for (const Segment& segment : segments) shade_over_time(ray, segment, phase, out);
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
      const uint32_t knot = add_knot(ray, seen, sample.time, keys_.next(sample.time), out);
      for (size_t i = sample.first; i < segments.size() && segments[i].begin < sample.end; ++i)
        out.add_part(part_of(segments[i], std::max(segments[i].begin, sample.begin),
                             std::min(segments[i].end, sample.end), knot));
    }
  }

  uint64_t evaluations() const { return evaluations_; }

 private:
  static constexpr uint64_t kShareDimension = 3;  // beside x, y and time
  static constexpr uint64_t kEndBranch = 21;      // of a knot's key, beside those of shading

  uint32_t add_knot(const Ray& ray, const Segment& seen, float time, const SampleKey& key, RecordBuilder& out) {
    ++evaluations_;
    const Shade shade = shader_.shade(ray, seen.mesh, seen.triangle, time, key);
    return out.add_knot(time, shade.colour, shade.normal, shade.albedo);
  }

  /// Adds a segment as one part: with a knot once in every cell of the grid, `phase` of a cell from its begin, and at
  /// both ends. Where nothing varies or in less than a cell there is one, anywhere with the same probability.
  void shade_over_time(const Ray& ray, const Segment& segment, float phase, RecordBuilder& out) {
    const TimeGrid& grid = options_.grid;
    const double begin = grid.place(segment.begin), end = grid.place(segment.end);
    // Half-open: at its very end something else is seen.
    const float latest = std::nextafter(segment.end, 0.0f);
    const auto inside = [&](float time) { return std::clamp(time, segment.begin, std::max(segment.begin, latest)); };
    const double first = std::ceil(begin - static_cast<double>(phase)),
                 after = std::ceil(end - static_cast<double>(phase));
    // Ends are named by their triangle: two of them may lie in the cell of a knot.
    const auto end_key = [&](double place, uint64_t which) {
      return keys_.at(std::floor(place)).branch(hash(kEndBranch, which, segment.mesh, segment.triangle));
    };
    SeenPart part{segment, out.knot_count(), 0};
    const auto add = [&](float time, const SampleKey& key) {
      add_knot(ray, segment, inside(time), key, out);
      ++part.knots;
    };
    const bool is_short = !shader_.varies(segment.mesh) || end - begin < 1;
    if (is_short && first < after) {
      add(grid.time_at(first + static_cast<double>(phase)), keys_.at(first));
    } else if (is_short) {
      const SampleKey key = end_key(begin, 0);
      const float place = unit_float(hash(key.seed, key.index, kShareDimension));
      add(segment.begin + (segment.end - segment.begin) * place, key);
    } else {
      add(segment.begin, end_key(begin, 0));
      for (double cell = first; cell < after; ++cell) {
        const float time = grid.time_at(cell + static_cast<double>(phase));
        if (time > segment.begin && time < latest) add(time, keys_.at(cell));
      }
      add(segment.end, end_key(end, 1));
    }
    out.add_part(part);
  }

  const Shader& shader_;
  ShadingOptions options_;
  LayerShading layers_;
  std::vector<ShadingSample> samples_;
  SampleKeys keys_;
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
