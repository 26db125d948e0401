// Discrete rays: each sees one instant.
#include "discrete/discrete_scene.h"
#include "integrators/discrete_samples.h"
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
    explicit QmcWorker(const QmcIntegrator& integrator)
        : context_(integrator.context_), samples_(context_, integrator.scene_), record_(context_.needs.surfaces()) {}

    const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override {
      record_.begin_pixel(x, y, context_.background, context_.times(x, y).window());
      record_.set_plan({0, context_.sampler.count()}, true);
      samples_.take(x, y, context_.sampler.pixel(x, y), 0, context_.sampler.count(), DiscreteLayer::all, record_,
                    monitor);
      return record_.finish();
    }

    void add_counts(RenderStats& stats) const override {
      stats.rays += samples_.ray_count();
      stats.segments += samples_.hit_count();
      stats.shading_samples += samples_.hit_count();
    }

   private:
    const PixelContext& context_;
    DiscreteSamples samples_;
    RecordBuilder record_;
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
