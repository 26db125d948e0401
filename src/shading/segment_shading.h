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
#include "shading/steady_shading.h"

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
      : shader_(shader), options_(options), layers_(shader), steady_(shader, options), keys_(options.grid) {}

  /// Appends the parts of the segments of ray `index` of a pixel, seen through `blended`, to `out`: they cover exactly
  /// what the segments cover, and each is part of one of them. phase: see spread_samples.
  /// window: that of the rays.
  void shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended,
             const TimeRange& window, uint64_t pixel_seed, uint32_t index, float phase, RecordBuilder& out) {
    if (options_.contrast > 0) {
      evaluations_ += steady_.shade(ray, segments, blended, window, pixel_seed, index, out);
      return;
    }
    keys_.begin_ray(pixel_seed, index);
    const double share = unit_float(hash(pixel_seed, index, kShareDimension));
    if (!blended.empty() || shader_.has_sky()) {
      evaluations_ += layers_.shade(ray, segments, blended, window, options_, share, phase, keys_, out);
      return;
    }
    const auto joined = [&](const Segment& first, const Segment& second) {
      return options_.clusters == Clusters::on && shader_.joined(first, second);
    };
    if (options_.over_time) {
      for (uint32_t first = 0, after = 0; first < segments.size(); first = after) {
        after = end_of_cluster(segments, first, joined);
        shade_over_time(ray, segments.subspan(first, after - first), phase, out);
      }
      return;
    }
    spread_samples(
        segments, options_.samples, share, phase, joined, [&](const Segment& s) { return shader_.varies(s.mesh); },
        samples_);
    for (const ShadingSample& sample : samples_) {
      const Segment& seen = segments[sample.segment];
      const uint32_t knot = add_knot(ray, seen, sample.time, keys_.next(sample.time), out);
      for (size_t i = sample.first; i < segments.size() && segments[i].begin < sample.end; ++i)
        out.add_part(part_of(segments[i], std::max(segments[i].begin, sample.begin),
                             std::min(segments[i].end, sample.end), knot));
    }
  }

  uint64_t evaluations() const { return evaluations_; }
  TraceCounters shadow_counters() const { return steady_.shadow_counters(); }  ///< of exact shadows

 private:
  static constexpr uint64_t kShareDimension = 3;  // beside x, y and time
  static constexpr uint64_t kEndBranch = 21;      // of a knot's key, beside those of shading

  uint32_t add_knot(const Ray& ray, const Segment& seen, float time, const SampleKey& key, RecordBuilder& out) {
    ++evaluations_;
    const Shade shade = shader_.shade(ray, seen.mesh, seen.triangle, time, key);
    return out.add_knot(time, shade.colour, shade.normal, shade.albedo);
  }

  /// When a cluster is shaded, and with which numbers.
  struct Instant {
    float time;
    SampleKey key;
  };

  /// Adds a cluster, each segment as one part. It is shaded at both ends, and once in every cell of the grid, `phase`
  /// of a cell from its begin, but for what is nearer than a cell to an end: as often, on average, as the cluster has
  /// cells. Where nothing varies or in less than a cell it is shaded once, anywhere with the same probability.
  void shade_over_time(const Ray& ray, std::span<const Segment> cluster, float phase, RecordBuilder& out) {
    choose_instants(cluster, phase);
    shades_.clear();
    size_t seen = 0;
    for (const Instant& instant : instants_) {
      while (cluster[seen].end <= instant.time && seen + 1 < cluster.size()) ++seen;
      shades_.push_back(shader_.shade(ray, cluster[seen].mesh, cluster[seen].triangle, instant.time, instant.key));
    }
    evaluations_ += instants_.size();
    const auto add_knot = [&](float time, const Shade& shade) {
      return out.add_knot(time, shade.colour, shade.normal, shade.albedo);
    };
    uint32_t knot = add_knot(instants_[0].time, shades_[0]);
    size_t next = 1;  // instant
    for (const Segment& segment : cluster) {
      SeenPart part{segment, knot, 1};
      if (instants_.size() > 1) {
        const bool last = &segment == &cluster.back();
        for (; next < instants_.size() && (last || instants_[next].time < segment.end); ++next, ++part.knots)
          knot = add_knot(instants_[next].time, shades_[next]);
        if (!last) {  // the colour goes on, and the next segment begins with this knot
          knot = add_knot(segment.end, between(next, segment.end));
          ++part.knots;
        }
      }
      out.add_part(part);
    }
  }

  /// Fills instants_.
  void choose_instants(std::span<const Segment> cluster, float phase) {
    const TimeGrid& grid = options_.grid;
    const Segment &front = cluster.front(), &back = cluster.back();
    const double begin = grid.place(front.begin), end = grid.place(back.end);
    // Half-open: at its very end something else is seen.
    const float latest = std::nextafter(back.end, 0.0f);
    const auto inside = [&](float time) { return std::clamp(time, front.begin, std::max(front.begin, latest)); };
    const double first = std::ceil(begin - static_cast<double>(phase)),
                 after = std::ceil(end - static_cast<double>(phase));
    // Ends are named by their triangle: two of them may lie in the cell of a knot.
    const auto end_key = [&](double place, uint64_t which, const Segment& segment) {
      return keys_.at(std::floor(place)).branch(hash(kEndBranch, which, segment.mesh, segment.triangle));
    };
    instants_.clear();
    const auto add = [&](float time, const SampleKey& key) { instants_.push_back({inside(time), key}); };
    const bool is_short = !shader_.varies(front.mesh) || end - begin < 1;
    if (is_short && first < after) {
      add(grid.time_at(first + static_cast<double>(phase)), keys_.at(first));
    } else if (is_short) {
      const SampleKey key = end_key(begin, 0, front);
      const float place = unit_float(hash(key.seed, key.index, kShareDimension));
      add(front.begin + (back.end - front.begin) * place, key);
    } else {
      add(front.begin, end_key(begin, 0, front));
      for (double cell = first + 1; cell + 1 < after; ++cell)
        add(grid.time_at(cell + static_cast<double>(phase)), keys_.at(cell));
      add(back.end, end_key(end, 1, back));
    }
  }

  /// On the straight line from the instant before `next` to that one.
  Shade between(size_t next, float time) const {
    const Shade &a = shades_[next - 1], &b = shades_[next];
    const float from = instants_[next - 1].time, to = instants_[next].time;
    return lerp(a, b, to > from ? (time - from) / (to - from) : 0.0f);
  }

  const Shader& shader_;
  ShadingOptions options_;
  LayerShading layers_;
  SteadyShading steady_;
  std::vector<ShadingSample> samples_;
  std::vector<Instant> instants_;
  std::vector<Shade> shades_;  // [instant]
  SampleKeys keys_;
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
