// Time-continuous rays for what moves, discrete rays for what stands still, in one pixel: as many of each as asked for
// (mixed) or as look best (auto). docs/method.md, "Static and moving in one pixel".
#include "integrators/cell_choice.h"
#include "integrators/integrator.h"
#include "integrators/mixed_frame.h"
#include "integrators/mixed_looks.h"
#include "integrators/mixed_worker.h"
#include "integrators/shadow_choice.h"

namespace kairos {

namespace {

class MixedIntegrator : public Integrator {
 public:
  MixedIntegrator(ShotParts& parts, const RenderParams& params, const PixelContext& context)
      : parts_(parts), key_(plan_key(params, context.needs)), frame_(parts, params, context) {
    if (const FramePlan* plan = params.exposure ? nullptr : parts.find_plan(key_)) {
      frame_.plan = *plan;
      frame_.use_shadows();
      frame_.use_cells();
      known_ = true;
    } else {
      frame_.estimate();
    }
  }

  std::unique_ptr<Worker> make_worker() const override {
    return make_cell_worker(frame_.cells, frame_.context,
                            [this](LookUps* look_ups) { return std::make_unique<MixedWorker>(frame_, look_ups); });
  }
  int tile_side() const override { return frame_.cells.side; }

  void prepare(Monitor& monitor, RenderStats& stats) override {
    if (frame_.automatic && !frame_.mask.empty()) stats.prices = frame_.plan.prices;
    if (known_) return;
    choose_shadows(frame_, monitor);
    if (frame_.shading.clusters == Clusters::pixel) {
      const CellChoice choice =
          choose_cells(frame_.context, frame_.shot, frame_.params, frame_.scene, frame_.look_ups(), monitor);
      frame_.plan.cells = choice.cells;
      frame_.light_error = choice.light_error;
    }
    frame_.use_cells();
    frame_.price_shared_light();
    look_around(frame_, monitor, stats);
    if (!frame_.params.exposure) parts_.keep_plan(key_, frame_.plan);  // the key does not know exposures
  }

  const Tracer& tracer() const { return frame_.tracer; }

 private:
  ShotParts& parts_;
  PlanKey key_;
  MixedFrame frame_;
  bool known_ = false;  // is the plan from an earlier picture?
};

}  // namespace

std::unique_ptr<Integrator> make_mixed_integrator(ShotParts& parts, const RenderParams& params,
                                                  const PixelContext& context, RenderStats& stats) {
  auto integrator = std::make_unique<MixedIntegrator>(parts, params, context);
  stats.instruction_set = integrator->tracer().instruction_set();
  stats.accel_memory_bytes = integrator->tracer().memory_bytes();
  return integrator;
}

}  // namespace kairos
