// Colours of a ray that sees through veils, or a background that is not the same everywhere.
#pragma once

#include <span>
#include <vector>

#include "integrators/integrator.h"
#include "integrators/layers.h"
#include "integrators/spread.h"

namespace kairos {

/// One thread's scratch memory.
class LayerShading {
 public:
  explicit LayerShading(const PixelContext& context) : shader_(context.shader) {}

  /// samples, share, phase: see spread_samples; every sample takes in all layers. key: of the next shading evaluation;
  /// counts on. Returns the number of evaluations. docs/method.md, "Veils".
  uint64_t shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> veils, int samples,
                 double share, float phase, SampleKey& key, std::vector<ShadedSegment>& out) {
    layers_.build(segments, veils, shader_.has_sky());
    const std::span<const Segment> stretches = layers_.stretches();
    const auto varies = [&](const Segment& stretch) {
      const auto index = static_cast<size_t>(&stretch - stretches.data());
      for (const uint32_t veil : layers_.before(index))
        if (shader_.varies(veils[veil].mesh)) return true;
      return stretch.mesh == kNoMesh ? shader_.sky_varies() : shader_.varies(stretch.mesh);
    };
    spread_samples(stretches, samples, share, phase, varies, samples_);
    const uint32_t first = key.index;
    for (const ShadingSample& sample : samples_) out.push_back(shade_one(ray, veils, sample, key));
    return key.index - first;
  }

 private:
  ShadedSegment shade_one(const Ray& ray, std::span<const Segment> veils, const ShadingSample& sample, SampleKey& key) {
    const Segment& back = layers_.stretches()[sample.segment];
    ShadedSegment all{sample.begin, sample.end, back.dist_begin, back.dist_end, {}, {}, {}, kNoMesh, 0};
    float open = 1;      // the share of the light from behind that comes through so far
    float heaviest = 0;  // the share of the layer that `all` is named after
    const auto add = [&](const Segment& layer, float share) {
      const Shade shade = shader_.shade(ray, layer.mesh, layer.triangle, sample.time, key);
      ++key.index;
      all.colour += shade.colour * share;
      all.normal += shade.normal * share;
      all.albedo += shade.albedo * share;
      if (all.mesh == kNoMesh) {
        all.dist_begin = distance_at(layer, sample.begin);
        all.dist_end = distance_at(layer, sample.end);
      }
      if (share <= heaviest) return;
      heaviest = share;
      all.mesh = layer.mesh;
      all.triangle = layer.triangle;
    };
    for (const uint32_t index : layers_.before(sample.segment)) {
      const Segment& veil = veils[index];
      const float opacity = shader_.opacity(ray, veil.mesh, veil.triangle, sample.time);
      if (opacity > 0) add(veil, open * opacity);
      open *= 1 - opacity;
      if (open <= 0) break;
    }
    if (open > 0 && back.mesh != kNoMesh) {
      add(back, open);
      open = 0;
    } else if (open > 0) {
      all.colour += shader_.sky(ray, sample.time) * open;
    }
    all.coverage = 1 - open;
    return all;
  }

  const Shader& shader_;
  Layers layers_;
  std::vector<ShadingSample> samples_;
};

}  // namespace kairos
