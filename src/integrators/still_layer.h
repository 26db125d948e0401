// What stands still, as the many cheap discrete rays of a pixel see it.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "integrators/discrete_samples.h"
#include "integrators/integrator.h"
#include "motion/aligned_points.h"

namespace kairos {

/// A colour and the values of the AOVs: of these, sums and differences make sense.
struct LayerLook {
  Vec3f colour, normal, albedo;
  float coverage = 0;

  LayerLook& operator+=(const LayerLook& other) {
    colour += other.colour;
    normal += other.normal;
    albedo += other.albedo;
    coverage += other.coverage;
    return *this;
  }
  friend LayerLook operator*(const LayerLook& a, float s) {
    return {a.colour * s, a.normal * s, a.albedo * s, a.coverage * s};
  }
};

/// The first rays of a pixel through what stands still, traced when they are first needed. One thread's scratch memory.
class StillLayer {
 public:
  StillLayer(const PixelContext& context, const DiscreteScene& scene) : context_(context), scene_(scene) {}

  /// align: of the pixel's time-continuous rays, among which these are to lie.
  void begin_pixel(int x, int y, const Sampler::Pixel& pixel, const AlignedPoints& align) {
    x_ = x;
    y_ = y;
    pixel_ = pixel;
    align_ = align;
    rays_.clear();
    times_.clear();
    hits_.clear();
  }

  /// Of `count` rays from `first` on, what they see of this layer: as Tracer::trace_packet takes it. Valid until the
  /// next call.
  std::span<const Segment> backdrops(uint32_t first, uint32_t count, Monitor& monitor) {
    trace(first + count, monitor);
    backdrops_.clear();
    for (uint32_t i = first; i < first + count; ++i) {
      Segment backdrop;
      if (hits_[i])
        backdrop = {0, 1, hits_[i]->dist, hits_[i]->dist, hits_[i]->mesh, hits_[i]->triangle, hits_[i]->front};
      backdrops_.push_back(backdrop);
    }
    return backdrops_;
  }

  /// How many of the first `count` rays hit something nearer than `dist`.
  uint32_t count_nearer(uint32_t count, double dist, Monitor& monitor) {
    trace(count, monitor);
    return static_cast<uint32_t>(
        std::count_if(hits_.begin(), hits_.begin() + count, [&](const auto& hit) { return hit && hit->dist < dist; }));
  }

  /// The mean over `all` rays, less that over the first `own` of them. time_of(sample time): when a ray looks.
  template <class TimeOf>
  LayerLook difference(uint32_t own, uint32_t all, Monitor& monitor, const TimeOf& time_of) {
    trace(all, monitor);
    LayerLook sum_all, sum_own;
    for (uint32_t i = 0; i < all; ++i) {
      const LayerLook look = shade(i, time_of(times_[i]));
      sum_all += look;
      if (i < own) sum_own += look;
    }
    LayerLook difference = sum_all * (1 / static_cast<float>(all));
    difference += sum_own * (-1 / static_cast<float>(own));
    return difference;
  }

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
        times_.push_back(point.time);
      }
      hits_.resize(end);
      scene_.intersect(std::span(rays_).subspan(begin), std::span(times_).subspan(begin),
                       std::span(hits_).subspan(begin), DiscreteLayer::still);
      ray_count_ += end - begin;
    }
  }

  LayerLook shade(uint32_t index, float time) {
    const Ray& ray = rays_[index];
    if (!hits_[index]) return {context_.shader.sky(ray, time), {}, {}, 0};
    ++evaluations_;
    const ShadedSegment seen = shade_hit(context_.shader, ray, time, *hits_[index], {pixel_.seed, index});
    return {seen.colour, seen.normal, seen.albedo, 1};
  }

  const PixelContext& context_;
  const DiscreteScene& scene_;
  int x_ = 0, y_ = 0;
  Sampler::Pixel pixel_;
  AlignedPoints align_;
  std::vector<Ray> rays_;
  std::vector<float> times_;
  std::vector<std::optional<DiscreteHit>> hits_;
  std::vector<Segment> backdrops_;
  uint64_t ray_count_ = 0, evaluations_ = 0;
};

}  // namespace kairos
