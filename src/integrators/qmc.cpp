// Discrete rays: each sees one instant.
#include <algorithm>
#include <array>

#include "discrete/discrete_scene.h"
#include "integrators/integrator.h"

namespace kairos {

namespace {

class QmcIntegrator : public Integrator {
 public:
  QmcIntegrator(const DiscreteScene& scene, const PixelContext& context) : context_(context), scene_(scene) {}

  std::unique_ptr<Worker> make_worker() const override { return std::make_unique<QmcWorker>(*this); }

 private:
  class QmcWorker : public Worker {
   public:
    explicit QmcWorker(const QmcIntegrator& integrator) : integrator_(integrator), context_(integrator.context_) {}

    void render_pixel(int x, int y, RaySink& sink, Monitor& monitor) override {
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      for (uint32_t begin = 0; begin < context_.sampler.count(); begin += kRaysPerPoll) {
        monitor.poll();
        const uint32_t count = std::min(kRaysPerPoll, context_.sampler.count() - begin);
        for (uint32_t i = 0; i < count; ++i) {
          const SamplePoint point = context_.sampler.point(pixel, begin + i);
          rays_[i] = context_.ray(x, y, point);
          times_[i] = point.time;
        }
        integrator_.scene_.intersect(std::span(rays_).first(count), std::span(times_).first(count),
                                     std::span(hits_).first(count));
        ray_count_ += count;
        for (uint32_t i = 0; i < count; ++i) add(rays_[i], times_[i], hits_[i], {pixel.seed, begin + i}, sink);
      }
    }

    void add_counts(RenderStats& stats) const override {
      stats.rays += ray_count_;
      stats.segments += hit_count_;
      stats.shading_samples += hit_count_;
    }

   private:
    void add(const Ray& ray, float time, const std::optional<DiscreteHit>& hit, SampleKey key, RaySink& sink) {
      if (!hit) return add_sky(context_.shader, ray, time, sink);
      ++hit_count_;
      const Shade shade = context_.shader.shade(ray, hit->mesh, hit->triangle, time, key);
      const ShadedSegment seen{time,         time,         hit->dist, hit->dist,    shade.colour,
                               shade.normal, shade.albedo, hit->mesh, hit->triangle};
      sink.add({ShadedRay::Kind::discrete, {&seen, 1}, 1});
    }

    const QmcIntegrator& integrator_;
    const PixelContext& context_;
    // The samples of one pixel lie next to each other and go through the scene together.
    std::array<Ray, kRaysPerPoll> rays_;
    std::array<float, kRaysPerPoll> times_{};
    std::array<std::optional<DiscreteHit>, kRaysPerPoll> hits_;
    uint64_t ray_count_ = 0, hit_count_ = 0;
  };

  const PixelContext& context_;
  const DiscreteScene& scene_;
};

}  // namespace

std::unique_ptr<Integrator> make_qmc_integrator(ShotParts& parts, const RenderParams& params,
                                                const PixelContext& context) {
  return std::make_unique<QmcIntegrator>(parts.discrete(params.discrete_keys), context);
}

}  // namespace kairos
