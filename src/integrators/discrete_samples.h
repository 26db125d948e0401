// Discrete samples of a pixel: rays that each see one instant, traced and shaded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "discrete/discrete_scene.h"
#include "integrators/integrator.h"
#include "shading/exact_mirrors.h"
#include "shading/exact_shadows.h"
#include "shading/look_ups.h"

namespace kairos {

/// Adds what discrete rays see to a record: one part each, of the sky only where it is not the same everywhere. One
/// thread's scratch memory.
class SeenByRays {
 public:
  /// look_ups: where not null, takes what would be shaded: knots get their colours later.
  explicit SeenByRays(const Shader& shader, LookUps* look_ups = nullptr) : shader_(shader), look_ups_(look_ups) {}

  /// Shades them all; key_of(i): of ray number i. For each ray in turn, calls add_ray(number, first part, parts).
  /// shadows: where they are exact, resting lights shine as if nothing passed before them; null: nowhere. mirrors:
  /// those that are exact show what stands still alone; null: none.
  template <class KeyOf, class AddRay>
  void add(std::span<const Ray> rays, std::span<const float> times, std::span<const std::optional<DiscreteHit>> hits,
           const KeyOf& key_of, RecordBuilder& out, const AddRay& add_ray, const ExactShadows* shadows = nullptr,
           const ExactMirrors* mirrors = nullptr) {
    queries_.clear();
    for (size_t i = 0; i < rays.size(); ++i)
      if (const auto& hit = hits[i]) {
        const bool exact = shadows != nullptr && shadows->on(hit->mesh);
        queries_.push_back({rays[i], hit->mesh, hit->triangle, times[i], shader_.width_at(hit->dist), key_of(i),
                            exact ? RestingLights::as_if_none_passed : RestingLights::as_is});
        if (mirrors != nullptr) queries_.back().still_in = &mirrors->meshes();
      }
    shades_.resize(queries_.size());
    if (look_ups_ == nullptr)
      shader_.shade(queries_, shades_);
    else if (out.keeps_surfaces())
      for (size_t i = 0; i < queries_.size(); ++i)
        shades_[i] = shader_.surface(queries_[i].ray, queries_[i].mesh, queries_[i].triangle, queries_[i].time);
    size_t next = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const uint32_t first = out.part_count();
      const float time = times[i];
      if (const auto& hit = hits[i]) {
        if (look_ups_ != nullptr) look_ups_->link(out.knot_count(), look_ups_->add(queries_[next]));
        const Shade& shade = shades_[next++];
        const uint32_t knot = out.add_knot(time, shade.colour, shade.normal, shade.albedo);
        out.add_part({{time, time, hit->dist, hit->dist, hit->mesh, hit->triangle, hit->front}, knot});
      } else if (shader_.has_sky()) {
        const uint32_t knot = out.add_knot(time, shader_.sky(rays[i], time), {}, {});
        out.add_part({{time, time, INFINITY, INFINITY, kNoMesh, 0, false}, knot});
      }
      add_ray(i, first, out.part_count() - first);
    }
  }

 private:
  const Shader& shader_;
  LookUps* const look_ups_;
  std::vector<ShadingQuery> queries_;
  std::vector<Shade> shades_;
};

/// One thread's scratch memory.
class DiscreteSamples {
 public:
  DiscreteSamples(const PixelContext& context, const DiscreteScene& scene, LookUps* look_ups = nullptr)
      : context_(context), scene_(scene), seen_(context.shader, look_ups), shades_now_(look_ups == nullptr) {}

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
      seen_.add(
          std::span(rays_).first(size), std::span(times_).first(size), std::span(hits_).first(size),
          [&](size_t i) {
            return SampleKey{pixel.seed, begin + static_cast<uint32_t>(i)};
          },
          out,
          [&](size_t i, uint32_t first, uint32_t parts) {
            out.add_ray({film_[i], 1, times_[i], first, parts, hits_[i].has_value(), times.density(times_[i])});
            hit_count_ += hits_[i].has_value();
          });
      begin += size;
    }
  }

  uint64_t ray_count() const { return ray_count_; }
  uint64_t hit_count() const { return hit_count_; }
  uint64_t evaluations() const { return shades_now_ ? hit_count_ : 0; }

 private:
  const PixelContext& context_;
  const DiscreteScene& scene_;
  SeenByRays seen_;
  bool shades_now_;
  std::array<Ray, kRaysPerPoll> rays_;
  std::array<Vec2f, kRaysPerPoll> film_{};
  std::array<float, kRaysPerPoll> times_{};
  std::array<std::optional<DiscreteHit>, kRaysPerPoll> hits_;
  uint64_t ray_count_ = 0, hit_count_ = 0;
};

}  // namespace kairos
