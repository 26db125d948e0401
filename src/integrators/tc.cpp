// Time-continuous rays: exact visibility over the shutter, sampled over the pixel, shaded at instants.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/cell_choice.h"
#include "integrators/cell_tiles.h"
#include "integrators/frame_plan.h"
#include "integrators/integrator.h"
#include "integrators/row_packet.h"
#include "integrators/shadow_choice.h"
#include "motion/aligned_points.h"
#include "policy/packet_choice.h"
#include "shading/exact_mirrors.h"
#include "shading/exact_shadows.h"
#include "shading/packet_shading.h"

namespace kairos {

namespace {

class TcIntegrator : public Integrator {
 public:
  TcIntegrator(ShotParts& parts, const RenderParams& params, const PixelContext& context)
      : parts_(parts),
        params_(params),
        key_(plan_key(params, context.needs)),
        context_(context),
        shading_(shading_options(parts.shot(), params, context.needs)),
        tracer_(parts.tracer(params.instruction_set)),
        scene_(is_lit(params.shading) ? &parts.discrete(params.discrete_keys) : nullptr),
        width_(parts.shot().projection.width) {
    // A single ray is nowhere better than anywhere else; and rays of shots that follow on each other are not to jump.
    if (context.sampler.count() > 1 && !context.needs.over_time())
      mask_ = &parts.motion_mask(context.filter.radius(), params.crop);
  }

  void prepare(Monitor& monitor, RenderStats& /*stats*/) override {
    if (const FramePlan* known = parts_.find_plan(key_)) {
      plan_ = *known;
    } else {
      make_plan(monitor);
      parts_.keep_plan(key_, plan_);
    }
    // Pixels with exposures of their own may look at different times.
    strip_ = context_.exposure ? 1 : plan_.packets.strip(context_.sampler.count());
    cells_ = plan_cells(parts_.shot(), params_, plan_.cells, look_ups());
    if (!plan_.exact_shadows.empty()) {
      shadows_.emplace(context_.shader, tracer_, *scene_, plan_.exact_shadows);
      shading_.shadows = &*shadows_;
    }
    if (!plan_.exact_mirrors.empty()) {
      mirrors_.emplace(context_.shader, tracer_, *scene_, plan_.exact_mirrors);
      shading_.mirrors = &*mirrors_;
    }
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
          packet_(context_),
          record_(context_.needs.surfaces()) {}

    const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override {
      const PixelTimes times = context_.times(x, y);
      record_.begin_pixel(x, y, context_.background, times.window());
      const uint32_t count = context_.sampler.count();
      record_.set_plan({count, 0}, true);
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      for (uint32_t begin = 0; begin < count; begin += kMostRays) {
        if (begin % kRaysPerPoll == 0) monitor.poll();
        if (integrator_.strip_ == 1)
          trace_alone(x, y, pixel, begin, times.limits());
        else if (!packet_.holds(x, y))
          trace_strip(x, y);
        const RowPacket::Rays rays = packet_.of(x);
        shade_rays(rays, pixel.seed, begin, times.window(), shading_, ends_, record_);
      }
      return record_.finish();
    }

    void add_counts(RenderStats& stats) const override {
      stats.counters += workspace_.counters();
      stats.counters += shading_.further_counters();
      stats.counters += packet_.shadow_counters();
      stats.rays += workspace_.counters().rays;
      stats.segments += workspace_.counters().segments;
      stats.shading_samples += shading_.evaluations();
    }

   private:
    static constexpr uint32_t kMostRays = RowPacket::kMostRays;

    AlignedPoints align(int x, int y) const {
      return integrator_.mask_ != nullptr ? align_points(*integrator_.mask_, x, y) : AlignedPoints();
    }
    void trace_alone(int x, int y, const Sampler::Pixel& pixel, uint32_t begin, const TraceLimits& limits) {
      const uint32_t count = context_.sampler.count();
      packet_.begin(y);
      packet_.add(x, pixel, align(x, y), begin, std::min(kMostRays, count - begin));
      packet_.trace(integrator_.tracer_, workspace_, integrator_.plan_.packets.together(count), limits,
                    shading_.packet_shadows());
    }
    void trace_strip(int x, int y) {
      const int left = x - x % integrator_.strip_;
      packet_.begin(y);
      for (int px = left; px < std::min(left + integrator_.strip_, integrator_.width_); ++px)
        packet_.add(px, context_.sampler.pixel(px, y), align(px, y), 0, context_.sampler.count());
      packet_.trace(integrator_.tracer_, workspace_, true, {}, shading_.packet_shadows());
    }

    const TcIntegrator& integrator_;
    const PixelContext& context_;
    Tracer::Workspace workspace_;
    PacketShading shading_;
    RowPacket packet_;
    RecordBuilder record_;
    std::vector<uint32_t> ends_;  // [ray of a packet]: of its parts
  };

  void make_plan(Monitor& monitor) {
    const Shot& shot = parts_.shot();
    plan_.packets = choose_packets(context_, shot.projection, tracer_);
    if (scene_ != nullptr)
      plan_.exact_shadows =
          choose_exact_shadows(context_, shot, params_, tracer_, *scene_, shading_, context_.sampler.count());
    // What mirrors show is exact, or shares light.
    if (params_.cells != Cells::on) plan_.exact_mirrors = choose_exact_mirrors(context_, params_, shading_);
    if (!plan_.exact_shadows.empty())
      for (size_t mesh = 0; mesh < plan_.exact_mirrors.size(); ++mesh)
        if (plan_.exact_mirrors[mesh]) plan_.exact_shadows[mesh] = false;
    if (scene_ != nullptr && plan_.exact_mirrors.empty() && shading_.clusters == Clusters::pixel)
      plan_.cells = choose_cells(context_, shot, params_, *scene_, look_ups(), monitor).cells;
  }

  double look_ups() const { return params_.tc_rays * shading_.samples; }

  ShotParts& parts_;
  const RenderParams params_;
  const PlanKey key_;
  const PixelContext& context_;
  ShadingOptions shading_;
  const Tracer& tracer_;
  const DiscreteScene* const scene_;  // of lit pictures
  const int width_;                   // of the frame
  const MotionMask* mask_ = nullptr;  // null to leave the points of a pixel where they are
  FramePlan plan_;
  int strip_ = 1;  // pixels that are traced together
  CellPlan cells_;
  std::optional<ExactShadows> shadows_;
  std::optional<ExactMirrors> mirrors_;
};

}  // namespace

std::unique_ptr<Integrator> make_tc_integrator(ShotParts& parts, const RenderParams& params,
                                               const PixelContext& context, RenderStats& stats) {
  const Tracer& tracer = parts.tracer(params.instruction_set);
  stats.instruction_set = tracer.instruction_set();
  stats.accel_memory_bytes = tracer.memory_bytes();
  return std::make_unique<TcIntegrator>(parts, params, context);
}

}  // namespace kairos
