// What stands still, as the many cheap discrete rays of a pixel see it.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "discrete/occluder_hint.h"
#include "integrators/discrete_samples.h"
#include "integrators/integrator.h"
#include "motion/aligned_points.h"

namespace kairos {

/// The first rays of a pixel through what stands still, traced when they are first needed. One thread's scratch memory.
class StillLayer {
 public:
  /// look_ups: see SeenByRays.
  StillLayer(const PixelContext& context, const DiscreteScene& scene, LookUps* look_ups = nullptr)
      : context_(context), scene_(scene), seen_(context.shader, look_ups), shades_now_(look_ups == nullptr) {}

  /// align: of the pixel's time-continuous rays, among which these are to lie.
  void begin_pixel(int x, int y, const Sampler::Pixel& pixel, const AlignedPoints& align) {
    x_ = x;
    y_ = y;
    pixel_ = pixel;
    align_ = align;
    pixel_times_ = context_.times(x, y);
    rays_.clear();
    film_.clear();
    times_.clear();
    hits_.clear();
  }

  /// What the first `count` rays hit. Valid until the next call.
  std::span<const std::optional<DiscreteHit>> hits(uint32_t count, Monitor& monitor) {
    trace(count, monitor);
    return std::span(hits_).first(count);
  }

  /// Of `count` rays from `first` on, what they see of this layer: as Tracer::trace_packet takes it. Valid until the
  /// next call.
  std::span<const Segment> occluder_hints(uint32_t first, uint32_t count, Monitor& monitor) {
    trace(first + count, monitor);
    occluder_hints_.clear();
    for (uint32_t i = first; i < first + count; ++i) occluder_hints_.push_back(occluder_hint(hits_[i]));
    return occluder_hints_;
  }

  /// How many of the first `count` rays hit something nearer than `dist`.
  uint32_t count_nearer(uint32_t count, double dist, Monitor& monitor) {
    trace(count, monitor);
    return static_cast<uint32_t>(
        std::count_if(hits_.begin(), hits_.begin() + count, [&](const auto& hit) { return hit && hit->dist < dist; }));
  }

  /// Adds rays [begin, end) and what they see to `out`. shadows, mirrors: see SeenByRays.
  void add_rays(uint32_t begin, uint32_t end, const ExactShadows* shadows, const ExactMirrors* mirrors,
                Monitor& monitor, RecordBuilder& out) {
    trace(end, monitor);
    const auto some = [&](auto& all) { return std::span(all).subspan(begin, end - begin); };
    seen_.add(
        some(rays_), some(times_), some(hits_),
        [&](size_t i) {
          return SampleKey{pixel_.seed, begin + static_cast<uint32_t>(i)};
        },
        out,
        [&](size_t i, uint32_t first, uint32_t parts) {
          out.add_still_ray({film_[begin + i], 1, times_[begin + i], first, parts, 0});
          evaluations_ += shades_now_ && hits_[begin + i].has_value();
        },
        shadows, mirrors);
  }
  SampleKey key(uint32_t index) const { return {pixel_.seed, index}; }
  /// Of those that were traced.
  const Ray& ray(uint32_t index) const { return rays_[index]; }

  uint64_t ray_count() const { return ray_count_; }
  uint64_t evaluations() const { return evaluations_; }

 private:
  void trace(uint32_t count, Monitor& monitor) {
    while (rays_.size() < count) {
      monitor.poll();
      const size_t begin = rays_.size(), end = std::min<size_t>(count, begin + kRaysPerPoll);
      for (size_t i = begin; i < end; ++i) {
        const SamplePoint point = align_(context_.sampler.point(pixel_, static_cast<uint32_t>(i)));
        rays_.push_back(context_.ray(x_, y_, point));
        film_.push_back(context_.film(point));
        times_.push_back(pixel_times_.instant(point.time));
      }
      hits_.resize(end);
      scene_.intersect(std::span(rays_).subspan(begin), std::span(times_).subspan(begin),
                       std::span(hits_).subspan(begin), DiscreteLayer::still);
      ray_count_ += end - begin;
    }
  }

  const PixelContext& context_;
  const DiscreteScene& scene_;
  SeenByRays seen_;
  bool shades_now_;
  int x_ = 0, y_ = 0;
  Sampler::Pixel pixel_;
  AlignedPoints align_;
  PixelTimes pixel_times_;
  std::vector<Ray> rays_;
  std::vector<Vec2f> film_;
  std::vector<float> times_;
  std::vector<std::optional<DiscreteHit>> hits_;
  std::vector<Segment> occluder_hints_;
  uint64_t ray_count_ = 0, evaluations_ = 0;
};

}  // namespace kairos
