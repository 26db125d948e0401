// Discrete rays: each sees one instant.
#include "discrete/discrete_scene.h"
#include "integrators/cell_choice.h"
#include "integrators/cell_tiles.h"
#include "integrators/discrete_samples.h"
#include "integrators/integrator.h"

namespace kairos {

namespace {

class QmcIntegrator : public Integrator {
 public:
  QmcIntegrator(const Shot& shot, const DiscreteScene& scene, const RenderParams& params, const PixelContext& context)
      : shot_(shot), params_(params), context_(context), scene_(scene) {}

  void prepare(Monitor& monitor, RenderStats& /*stats*/) override {
    const auto cells = choose_cells(context_, shot_, params_, scene_, params_.spp, monitor).cells;
    cells_ = plan_cells(shot_, params_, cells, params_.spp);
  }

  std::unique_ptr<Worker> make_worker() const override {
    return make_cell_worker(cells_, context_,
                            [this](LookUps* look_ups) { return std::make_unique<QmcWorker>(*this, look_ups); });
  }
  int tile_side() const override { return cells_.side; }

 private:
  class QmcWorker : public Worker {
   public:
    QmcWorker(const QmcIntegrator& integrator, LookUps* look_ups)
        : context_(integrator.context_),
          samples_(context_, integrator.scene_, look_ups),
          record_(context_.needs.surfaces()) {}

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
      stats.shading_samples += samples_.evaluations();
    }

   private:
    const PixelContext& context_;
    DiscreteSamples samples_;
    RecordBuilder record_;
  };

  const Shot& shot_;
  const RenderParams params_;
  const PixelContext& context_;
  const DiscreteScene& scene_;
  CellPlan cells_;
};

}  // namespace

std::unique_ptr<Integrator> make_qmc_integrator(ShotParts& parts, const RenderParams& params,
                                                const PixelContext& context) {
  return std::make_unique<QmcIntegrator>(parts.shot(), parts.discrete(params.discrete_keys), params, context);
}

}  // namespace kairos
