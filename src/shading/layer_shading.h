// Colours of a ray that sees through veils, or a background that is not the same everywhere.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "pixel/shaded_segment.h"
#include "shading/layers.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// One thread's scratch memory.
class LayerShading {
 public:
  explicit LayerShading(const Shader& shader) : shader_(shader) {}

  /// options, share, phase: see spread_samples; every sample takes in all layers. key: of the next shading evaluation;
  /// counts on. Returns the number of evaluations. docs/method.md, "Veils".
  uint64_t shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> veils,
                 ShadingOptions options, double share, float phase, SampleKey& key, std::vector<ShadedSegment>& out) {
    layers_.build(segments, veils, shader_.has_sky());
    veils_ = veils;
    const std::span<const Segment> stretches = layers_.stretches();
    const auto index_of = [&](const Segment& stretch) { return static_cast<size_t>(&stretch - stretches.data()); };
    const auto joined = [&](const Segment& first, const Segment& second) {
      return options.clusters == Clusters::on && layers_joined(index_of(first), index_of(second));
    };
    const auto varies = [&](const Segment& stretch) {
      for (const uint32_t veil : layers_.before(index_of(stretch)))
        if (shader_.varies(veils[veil].mesh)) return true;
      return stretch.mesh == kNoMesh ? shader_.sky_varies() : shader_.varies(stretch.mesh);
    };
    spread_samples(stretches, options.samples, share, phase, joined, varies, samples_);
    const uint32_t first = key.index;
    for (const ShadingSample& sample : samples_) {
      const View view = view_at(ray, sample, key);
      for (size_t i = sample.first; i < stretches.size() && stretches[i].begin < sample.end; ++i)
        out.push_back(part_of(i, sample, view));
    }
    return key.index - first;
  }

 private:
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  /// All layers at an instant.
  struct View {
    Vec3f colour, normal, albedo;
    float coverage = 0;
    size_t nearest = kNone;  // of the layers, counted from the front, the first that is seen
    size_t named = kNone;    // and that with the largest share
  };

  /// Layer `depth` of a stretch: a veil, or what is behind them all.
  const Segment& layer(size_t stretch, size_t depth) const {
    const std::span<const uint32_t> before = layers_.before(stretch);
    return depth < before.size() ? veils_[before[depth]] : layers_.stretches()[stretch];
  }

  bool layers_joined(size_t first, size_t second) const {
    const size_t veils = layers_.before(first).size();
    if (layers_.before(second).size() != veils) return false;
    for (size_t depth = 0; depth < veils; ++depth)
      if (!shader_.joined(layer(first, depth), layer(second, depth))) return false;
    const Segment &back = layer(first, veils), &next = layer(second, veils);
    return back.mesh == kNoMesh ? next.mesh == kNoMesh : shader_.joined(back, next);
  }

  View view_at(const Ray& ray, const ShadingSample& sample, SampleKey& key) const {
    View view;
    float open = 1;      // the share of the light from behind that comes through so far
    float heaviest = 0;  // the share of the layer `named`
    const auto add = [&](size_t depth, float share) {
      const Segment& seen = layer(sample.segment, depth);
      const Shade shade = shader_.shade(ray, seen.mesh, seen.triangle, sample.time, key);
      ++key.index;
      view.colour += shade.colour * share;
      view.normal += shade.normal * share;
      view.albedo += shade.albedo * share;
      if (view.nearest == kNone) view.nearest = depth;
      if (share <= heaviest) return;
      heaviest = share;
      view.named = depth;
    };
    const size_t veils = layers_.before(sample.segment).size();
    for (size_t depth = 0; depth < veils && open > 0; ++depth) {
      const Segment& veil = layer(sample.segment, depth);
      const float opacity = shader_.opacity(ray, veil.mesh, veil.triangle, sample.time);
      if (opacity > 0) add(depth, open * opacity);
      open *= 1 - opacity;
    }
    if (open > 0 && layer(sample.segment, veils).mesh != kNoMesh) {
      add(veils, open);
      open = 0;
    } else if (open > 0) {
      view.colour += shader_.sky(ray, sample.time) * open;
    }
    view.coverage = 1 - open;
    return view;
  }

  /// What the sample stands for within a stretch. The stretches of a cluster have the same number of layers.
  ShadedSegment part_of(size_t stretch, const ShadingSample& sample, const View& view) const {
    const Segment& within = layers_.stretches()[stretch];
    const float begin = std::max(within.begin, sample.begin), end = std::min(within.end, sample.end);
    const Segment& nearest = view.nearest == kNone ? within : layer(stretch, view.nearest);
    ShadedSegment part{
        begin,   end, distance_at(nearest, begin), distance_at(nearest, end), view.colour, view.normal, view.albedo,
        kNoMesh, 0};
    if (view.named != kNone) {
      part.mesh = layer(stretch, view.named).mesh;
      part.triangle = layer(stretch, view.named).triangle;
    }
    part.coverage = view.coverage;
    return part;
  }

  const Shader& shader_;
  Layers layers_;
  std::span<const Segment> veils_;  // of the ray being shaded
  std::vector<ShadingSample> samples_;
};

}  // namespace kairos
