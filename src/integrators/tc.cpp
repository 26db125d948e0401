// Time-continuous rays: exact visibility over the shutter, sampled over the pixel, shaded at instants.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/cell_tiles.h"
#include "integrators/frame_plan.h"
#include "integrators/integrator.h"
#include "integrators/shadow_choice.h"
#include "motion/aligned_points.h"
#include "policy/packet_choice.h"
#include "shading/exact_shadows.h"
#include "shading/packet_shading.h"

namespace kairos {

namespace {

class TcIntegrator : public Integrator {
 public:
  /// mask: null to leave the points of a pixel where they are.
  /// scene: where the plan has exact shadows.
  TcIntegrator(const FramePlan& plan, const CellPlan& cells, const MotionMask* mask, const Tracer& tracer,
               const DiscreteScene* scene, ShadingOptions shading, const PixelContext& context)
      : context_(context), shading_(shading), cells_(cells), mask_(mask), tracer_(tracer), packets_(plan.packets) {
    if (plan.exact_shadows.empty()) return;
    shadows_.emplace(context.shader, tracer, *scene, plan.exact_shadows);
    shading_.shadows = &*shadows_;
  }

  std::unique_ptr<Worker> make_worker() const override {
    return make_cell_worker(cells_, context_,
                            [this](LookUps* look_ups) { return std::make_unique<TcWorker>(*this, look_ups); });
  }
  int tile_side() const override { return cells_.side; }

 private:
  class TcWorker : public Worker {
   public:
    TcWorker(const TcIntegrator& integrator, LookUps* look_ups)
        : integrator_(integrator),
          context_(integrator.context_),
          shading_(integrator.context_.shader, integrator.shading_, look_ups),
          record_(context_.needs.surfaces()) {}

    const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override {
      const PixelTimes times = context_.times(x, y);
      record_.begin_pixel(x, y, context_.background, times.window());
      record_.set_plan({context_.sampler.count(), 0}, true);
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      const uint32_t count = context_.sampler.count();
      const AlignedPoints align =
          integrator_.mask_ != nullptr ? align_points(*integrator_.mask_, x, y) : AlignedPoints();
      for (uint32_t begin = 0; begin < count; begin += kMostRays) {
        if (begin % kRaysPerPoll == 0) monitor.poll();
        const uint32_t size = std::min(kMostRays, count - begin);
        for (uint32_t i = 0; i < size; ++i) {
          const SamplePoint point = align(context_.sampler.point(pixel, begin + i));
          rays_[i] = context_.ray(x, y, point);
          film_[i] = context_.film(point);
          times_[i] = point.time;
        }
        const std::span<const Ray> rays = std::span(rays_).first(size);
        const auto seen = integrator_.tracer_.trace_packet(rays, Visibility::visible, workspace_, {},
                                                           integrator_.packets_.together(count), times.limits());
        ends_.clear();
        uint32_t first = record_.part_count();
        shading_.shade({rays, seen, std::span(times_).first(size), pixel.seed, begin, times.window()}, record_, ends_);
        for (uint32_t i = 0; i < size; ++i) {
          record_.add_ray({film_[i], 1, PixelRay::kAll, first, ends_[i] - first,
                           static_cast<uint32_t>(seen[i].segments.size() + seen[i].blended.size())});
          first = ends_[i];
        }
      }
      return record_.finish();
    }

    void add_counts(RenderStats& stats) const override {
      stats.counters += workspace_.counters();
      stats.counters += shading_.shadow_counters();
      stats.rays += workspace_.counters().rays;
      stats.segments += workspace_.counters().segments;
      stats.shading_samples += shading_.evaluations();
    }

   private:
    static constexpr uint32_t kMostRays = Tracer::kMaxPacket;

    const TcIntegrator& integrator_;
    const PixelContext& context_;
    Tracer::Workspace workspace_;
    std::array<Ray, kMostRays> rays_;
    std::array<Vec2f, kMostRays> film_{};
    std::array<float, kMostRays> times_{};  // of the sample points
    PacketShading shading_;
    RecordBuilder record_;
    std::vector<uint32_t> ends_;  // [ray of a packet]: of its parts
  };

  const PixelContext& context_;

  ShadingOptions shading_;
  CellPlan cells_;
  const MotionMask* mask_;
  const Tracer& tracer_;
  PacketChoice packets_;
  std::optional<ExactShadows> shadows_;
};

}  // namespace

std::unique_ptr<Integrator> make_tc_integrator(ShotParts& parts, const RenderParams& params,
                                               const PixelContext& context, RenderStats& stats) {
  const Tracer& tracer = parts.tracer(params.instruction_set);
  stats.instruction_set = tracer.instruction_set();
  stats.accel_memory_bytes = tracer.memory_bytes();
  const PlanKey key = plan_key(params, context.needs);
  const FramePlan* known = parts.find_plan(key);
  const ShadingOptions shading = shading_options(parts.shot(), params, context.needs);
  const DiscreteScene* scene = is_lit(params.shading) ? &parts.discrete(params.discrete_keys) : nullptr;
  FramePlan plan;
  if (known != nullptr) {
    plan = *known;
  } else {
    plan.packets = choose_packets(context, parts.shot().projection, tracer);
    if (scene != nullptr)
      plan.exact_shadows = choose_exact_shadows(context, parts.shot(), params, tracer, *scene, shading);
    parts.keep_plan(key, plan);
  }
  // A single ray is nowhere better than anywhere else; and rays of shots that follow on each other are not to jump.
  const MotionMask* mask = context.sampler.count() > 1 && !context.needs.over_time()
                               ? &parts.motion_mask(context.filter.radius(), params.crop)
                               : nullptr;
  CellPlan cells;
  if (shading.clusters == Clusters::pixel)
    cells = plan_cells(parts.shot(), params, context.needs, params.tc_rays * shading.samples);
  return std::make_unique<TcIntegrator>(plan, cells, mask, tracer, scene, shading, context);
}

}  // namespace kairos
