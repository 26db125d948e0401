// Discrete samples of a pixel: rays that each see one instant, traced and shaded.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "discrete/discrete_scene.h"
#include "integrators/integrator.h"

namespace kairos {

/// What a discrete ray sees, as its consumers want it.
inline ShadedSegment shade_hit(const Shader& shader, const Ray& ray, float time, const DiscreteHit& hit,
                               SampleKey key) {
  const Shade shade = shader.shade(ray, hit.mesh, hit.triangle, time, key);
  return {time, time, hit.dist, hit.dist, shade.colour, shade.normal, shade.albedo, hit.mesh, hit.triangle};
}

/// One thread's scratch memory.
class DiscreteSamples {
 public:
  DiscreteSamples(const PixelContext& context, const DiscreteScene& scene) : context_(context), scene_(scene) {}

  /// Samples [begin, end) of pixel (x, y), in their order. Those of one pixel lie next to each other and go through the
  /// scene together.
  void take(int x, int y, const Sampler::Pixel& pixel, uint32_t begin, uint32_t end, DiscreteLayer layer, RaySink& sink,
            Monitor& monitor) {
    while (begin < end) {
      monitor.poll();
      const uint32_t size = std::min(kRaysPerPoll, end - begin);
      for (uint32_t i = 0; i < size; ++i) {
        const SamplePoint point = context_.sampler.point(pixel, begin + i);
        rays_[i] = context_.ray(x, y, point);
        times_[i] = point.time;
      }
      scene_.intersect(std::span(rays_).first(size), std::span(times_).first(size), std::span(hits_).first(size),
                       layer);
      ray_count_ += size;
      for (uint32_t i = 0; i < size; ++i) {
        if (!hits_[i]) {
          add_sky(context_.shader, rays_[i], times_[i], sink);
          continue;
        }
        ++hit_count_;
        const ShadedSegment seen = shade_hit(context_.shader, rays_[i], times_[i], *hits_[i], {pixel.seed, begin + i});
        sink.add({ShadedRay::Kind::discrete, {&seen, 1}, 1});
      }
      begin += size;
    }
  }

  uint64_t ray_count() const { return ray_count_; }
  uint64_t hit_count() const { return hit_count_; }  ///< as many are shaded

 private:
  const PixelContext& context_;
  const DiscreteScene& scene_;
  std::array<Ray, kRaysPerPoll> rays_;
  std::array<float, kRaysPerPoll> times_{};
  std::array<std::optional<DiscreteHit>, kRaysPerPoll> hits_;
  uint64_t ray_count_ = 0, hit_count_ = 0;
};

}  // namespace kairos
