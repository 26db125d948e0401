// Colours of a ray that sees through blended surfaces, or a background that is not the same everywhere.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/layers.h"
#include "shading/roulette.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// One thread's scratch memory.
class LayerShading {
 public:
  explicit LayerShading(const Shader& shader) : shader_(shader) {}

  /// options, share, phase: see spread_samples; every sample takes in all layers, each of which is a part of its own.
  /// keys: of this ray. Returns the number of evaluations. docs/method.md, "Blended surfaces".
  uint64_t shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended,
                 const TimeRange& window, const ShadingOptions& options, double share, float phase, SampleKeys& keys,
                 RecordBuilder& out) {
    opacities_.clear();
    for (const Segment& hit : blended)
      opacities_.push_back(shader_.opacity(ray, hit.mesh, hit.triangle, 0.5f * (hit.begin + hit.end)));
    layers_.build(segments, blended, shader_.has_sky(), opacities_, window);
    blended_ = blended;
    const std::span<const Segment> stretches = layers_.stretches();
    const auto index_of = [&](const Segment& stretch) { return static_cast<size_t>(&stretch - stretches.data()); };
    const auto joined = [&](const Segment& first, const Segment& second) {
      return options.clusters == Clusters::on && layers_joined(index_of(first), index_of(second));
    };
    const auto varies = [&](const Segment& stretch) {
      for (const uint32_t index : layers_.before(index_of(stretch)))
        if (shader_.varies(blended[index].mesh)) return true;
      return stretch.mesh == kNoMesh ? shader_.sky_varies() : shader_.varies(stretch.mesh);
    };
    if (options.over_time)
      cut_at_cells(stretches, options.grid, phase, joined, varies);
    else
      spread_samples(stretches, options.samples, share, phase, joined, varies, samples_);
    evaluations_ = 0;
    for (const ShadingSample& sample : samples_) {
      look(ray, sample, keys, out);
      for (size_t i = sample.first; i < stretches.size() && stretches[i].begin < sample.end; ++i)
        add_parts(i, sample, out);
    }
    return evaluations_;
  }

 private:
  /// A layer at the instant of a sample.
  struct Seen {
    size_t depth;            // counted from the front, with those of which nothing is seen
    const Segment* farther;  // null, or one that has no depth because it is not among the nearest
    uint32_t knot;
    float opacity;
  };

  /// Layer `depth` of a stretch: a blended surface, or what is behind them all.
  const Segment& layer(size_t stretch, size_t depth) const {
    const std::span<const uint32_t> before = layers_.before(stretch);
    return depth < before.size() ? blended_[before[depth]] : layers_.stretches()[stretch];
  }

  bool layers_joined(size_t first, size_t second) const {
    const size_t count = layers_.before(first).size();
    if (layers_.before(second).size() != count) return false;
    for (size_t depth = 0; depth < count; ++depth)
      if (!shader_.joined(layer(first, depth), layer(second, depth))) return false;
    const Segment &back = layer(first, count), &next = layer(second, count);
    return back.mesh == kNoMesh ? next.mesh == kNoMesh : shader_.joined(back, next);
  }

  /// Fills samples_: one for each cell of the grid that a cluster of stretches reaches into, anywhere in its part of
  /// the cell with the same probability. A cluster that is shorter than a cell has one.
  template <class Joined, class Varies>
  void cut_at_cells(std::span<const Segment> stretches, const TimeGrid& grid, float phase, const Joined& joined,
                    const Varies& varies) {
    samples_.clear();
    for (uint32_t first = 0; first < stretches.size();) {
      const uint32_t after = end_of_cluster(stretches, first, joined);
      float begin = stretches[first].begin;
      const float last = stretches[after - 1].end;
      const bool is_short = grid.place(last) - grid.place(begin) < 1 || !varies(stretches[first]);
      uint32_t lies_in = first;
      for (double cell = std::floor(grid.place(begin)) + 1; begin < last; ++cell) {
        const float end = is_short ? last : std::clamp(grid.time_at(cell), begin, last);
        if (!(begin < end)) continue;
        const float latest = std::nextafter(end, 0.0f);
        const float time = std::clamp(begin + (end - begin) * phase, begin, latest);
        while (stretches[first].end <= begin) ++first;
        while (stretches[lies_in].end <= time) ++lies_in;
        samples_.push_back({first, lies_in, begin, end, time});
        begin = end;
      }
      first = after;
    }
  }

  /// Fills seen_.
  void look(const Ray& ray, const ShadingSample& sample, SampleKeys& keys, RecordBuilder& out) {
    seen_.clear();
    const auto add = [&](const Segment& surface, size_t depth, const Segment* farther, float opacity) {
      const Shade shade = shader_.shade(ray, surface.mesh, surface.triangle, sample.time, keys.next(sample.time));
      ++evaluations_;
      seen_.push_back({depth, farther, out.add_knot(sample.time, shade.colour, shade.normal, shade.albedo), opacity});
    };
    float open = 1;  // the share of the light from behind that comes through so far
    const auto add_blended = [&](const Segment& hit, size_t depth, const Segment* farther) {
      float opacity = shader_.opacity(ray, hit.mesh, hit.triangle, sample.time);
      if (open * (1 - opacity) < kLeastOpen) opacity = roulette(open, opacity, chance(ray, sample.time, hit));
      if (opacity > 0) add(hit, depth, farther, opacity);
      open *= 1 - opacity;
    };
    const size_t count = layers_.before(sample.segment).size();
    for (size_t depth = 0; depth < count && open > 0; ++depth)
      add_blended(layer(sample.segment, depth), depth, nullptr);
    if (open > 0 && layers_.is_cut(sample.segment)) {
      layers_.find_farther(sample.segment, sample.time, blended_, farther_);
      for (size_t i = 0; i < farther_.size() && open > 0; ++i)
        add_blended(blended_[farther_[i]], 0, &blended_[farther_[i]]);
    }
    if (!(open > 0)) return;
    const Segment& back = layer(sample.segment, count);
    if (back.mesh != kNoMesh)
      add(back, count, nullptr, 1);
    else if (shader_.has_sky() || seen_.empty())
      seen_.push_back({count, nullptr, out.add_knot(sample.time, shader_.sky(ray, sample.time), {}, {}), 1});
  }

  /// The same whenever asked, and another for each ray, instant and surface.
  static float chance(const Ray& ray, float time, const Segment& hit) {
    const auto bits = [](float a, float b) {
      return static_cast<uint64_t>(std::bit_cast<uint32_t>(a)) << 32 | std::bit_cast<uint32_t>(b);
    };
    constexpr uint64_t kRoulette = 0x726f756c65747465;  // "roulette": another number than AlphaCutOuts::solid's
    const Vec3f &from = ray.origin, &way = ray.direction;
    return unit_float(hash(bits(from.x, from.y), bits(from.z, time), bits(way.x, way.y), bits(way.z, 0),
                           static_cast<uint64_t>(hit.mesh) << 32 | hit.triangle, kRoulette));
  }

  /// What the sample stands for within a stretch. The stretches of a cluster have the same number of layers.
  void add_parts(size_t stretch, const ShadingSample& sample, RecordBuilder& out) const {
    const Segment& within = layers_.stretches()[stretch];
    const float begin = std::max(within.begin, sample.begin), end = std::min(within.end, sample.end);
    uint32_t number = 0;
    for (const Seen& seen : seen_) {
      const Segment& surface = seen.farther != nullptr ? *seen.farther : layer(stretch, seen.depth);
      out.add_part({{begin, end, distance_at(surface, begin), distance_at(surface, end), surface.mesh, surface.triangle,
                     surface.front},
                    seen.knot,
                    1,
                    number++,
                    seen.opacity});
    }
  }

  const Shader& shader_;
  Layers layers_;
  std::span<const Segment> blended_;  // of the ray being shaded
  std::vector<ShadingSample> samples_;
  std::vector<float> opacities_;  // [blended hit], halfway through
  std::vector<uint32_t> farther_;
  std::vector<Seen> seen_;
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
