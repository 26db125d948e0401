// Discrete samples of a pixel: rays that each see one instant, traced and shaded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "discrete/discrete_scene.h"
#include "integrators/integrator.h"

namespace kairos {

/// Adds what a discrete ray sees to `out`: of the sky a part only where it is not the same everywhere. Returns the
/// number of parts.
inline uint32_t add_seen(const Shader& shader, const Ray& ray, float time, const std::optional<DiscreteHit>& hit,
                         SampleKey key, RecordBuilder& out) {
  if (hit) {
    const Shade shade = shader.shade(ray, hit->mesh, hit->triangle, time, key);
    const uint32_t knot = out.add_knot(time, shade.colour, shade.normal, shade.albedo);
    out.add_part({{time, time, hit->dist, hit->dist, hit->mesh, hit->triangle, hit->front}, knot});
    return 1;
  }
  if (!shader.has_sky()) return 0;
  const uint32_t knot = out.add_knot(time, shader.sky(ray, time), {}, {});
  out.add_part({{time, time, INFINITY, INFINITY, kNoMesh, 0, false}, knot});
  return 1;
}

/// One thread's scratch memory.
class DiscreteSamples {
 public:
  DiscreteSamples(const PixelContext& context, const DiscreteScene& scene) : context_(context), scene_(scene) {}

  /// Samples [begin, end) of pixel (x, y), in their order. Those of one pixel lie next to each other and go through the
  /// scene together.
  void take(int x, int y, const Sampler::Pixel& pixel, uint32_t begin, uint32_t end, DiscreteLayer layer,
            RecordBuilder& out, Monitor& monitor) {
    const PixelTimes times = context_.times(x, y);
    while (begin < end) {
      monitor.poll();
      const uint32_t size = std::min(kRaysPerPoll, end - begin);
      for (uint32_t i = 0; i < size; ++i) {
        const SamplePoint point = context_.sampler.point(pixel, begin + i);
        rays_[i] = context_.ray(x, y, point);
        film_[i] = context_.film(point);
        times_[i] = times.instant(point.time);
      }
      scene_.intersect(std::span(rays_).first(size), std::span(times_).first(size), std::span(hits_).first(size),
                       layer);
      ray_count_ += size;
      for (uint32_t i = 0; i < size; ++i) {
        const uint32_t first = out.part_count();
        const uint32_t parts = add_seen(context_.shader, rays_[i], times_[i], hits_[i], {pixel.seed, begin + i}, out);
        out.add_ray({film_[i], 1, times_[i], first, parts, hits_[i].has_value(), times.density(times_[i])});
        hit_count_ += hits_[i].has_value();
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
  std::array<Vec2f, kRaysPerPoll> film_{};
  std::array<float, kRaysPerPoll> times_{};
  std::array<std::optional<DiscreteHit>, kRaysPerPoll> hits_;
  uint64_t ray_count_ = 0, hit_count_ = 0;
};

}  // namespace kairos
