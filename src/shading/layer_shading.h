// Colours of a ray that sees through blended surfaces, or a background that is not the same everywhere.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "pixel/record_builder.h"
#include "shading/layers.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// One thread's scratch memory.
class LayerShading {
 public:
  explicit LayerShading(const Shader& shader) : shader_(shader) {}

  /// options, share, phase: see spread_samples; every sample takes in all layers, each of which is a part of its own.
  /// key: of the next shading evaluation; counts on. Returns the number of evaluations. docs/method.md, "Blended
  /// surfaces".
  uint64_t shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended,
                 ShadingOptions options, double share, float phase, SampleKey& key, RecordBuilder& out) {
    layers_.build(segments, blended, shader_.has_sky());
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
    spread_samples(stretches, options.samples, share, phase, joined, varies, samples_);
    const uint32_t first = key.index;
    for (const ShadingSample& sample : samples_) {
      look(ray, sample, key, out);
      for (size_t i = sample.first; i < stretches.size() && stretches[i].begin < sample.end; ++i)
        add_parts(i, sample, out);
    }
    return key.index - first;
  }

 private:
  /// A layer at the instant of a sample.
  struct Seen {
    size_t depth;  // counted from the front, with those of which nothing is seen
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

  /// Fills seen_.
  void look(const Ray& ray, const ShadingSample& sample, SampleKey& key, RecordBuilder& out) {
    seen_.clear();
    const auto add = [&](size_t depth, float opacity) {
      const Segment& surface = layer(sample.segment, depth);
      const Shade shade = shader_.shade(ray, surface.mesh, surface.triangle, sample.time, key);
      ++key.index;
      seen_.push_back({depth, out.add_knot(sample.time, shade.colour, shade.normal, shade.albedo), opacity});
    };
    float open = 1;  // the share of the light from behind that comes through so far
    const size_t count = layers_.before(sample.segment).size();
    for (size_t depth = 0; depth < count && open > 0; ++depth) {
      const Segment& surface = layer(sample.segment, depth);
      const float opacity = shader_.opacity(ray, surface.mesh, surface.triangle, sample.time);
      if (opacity > 0) add(depth, opacity);
      open *= 1 - opacity;
    }
    if (!(open > 0)) return;
    if (layer(sample.segment, count).mesh != kNoMesh)
      add(count, 1);
    else if (shader_.has_sky() || seen_.empty())
      seen_.push_back({count, out.add_knot(sample.time, shader_.sky(ray, sample.time), {}, {}), 1});
  }

  /// What the sample stands for within a stretch. The stretches of a cluster have the same number of layers.
  void add_parts(size_t stretch, const ShadingSample& sample, RecordBuilder& out) const {
    const Segment& within = layers_.stretches()[stretch];
    const float begin = std::max(within.begin, sample.begin), end = std::min(within.end, sample.end);
    uint32_t number = 0;
    for (const Seen& seen : seen_) {
      const Segment& surface = layer(stretch, seen.depth);
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
  std::vector<Seen> seen_;
};

}  // namespace kairos
