// Time-continuous rays for what moves, discrete rays for what stands still, in one pixel. docs/method.md, "Static and
// moving in one pixel".
//
// Let W_k be the share of the shutter in which time-continuous ray k sees the still layer (background included), S_k
// that layer's colour along the ray, and L_k all of what the ray sees. Still rays are cheap, so there are more of them.
// With their mean S and the mean S' over those that lie on the time-continuous rays' own places, the control variate
//   I = mean_k(L_k) + mean_k(W_k) (S - S')
// takes from the still layer the noise of the few rays and puts in that of the many. It is handed on as segments: the
// still parts of every ray get the colour L_k's sample had, plus (S - S'), which sums to the same.
#include <mutex>

#include "base/parallel.h"
#include "discrete/discrete_scene.h"
#include "integrators/contrast.h"
#include "integrators/discrete_samples.h"
#include "integrators/integrator.h"
#include "integrators/packet_choice.h"
#include "integrators/still_layer.h"
#include "motion/aligned_points.h"
#include "motion/motion_mask.h"
#include "policy/allotment.h"
#include "policy/sample_spread.h"
#include "shading/packet_shading.h"

namespace kairos {

namespace {

/// A veil that stands still hides nothing, so it is no backdrop, and is traced with what moves.
bool has_still_veil(const Shot& shot, const Shader& shader) {
  for (uint32_t m = 0; m < shot.meshes.size(); ++m)
    if (shot.meshes[m].is_static() && shader.cut_outs() && shader.cut_outs()->is_veil(m)) return true;
  return false;
}

/// Pixels in which the picture is looked at beforehand, for where samples are needed: it takes
/// about a hundredth of the time.
constexpr uint64_t kPixelsPerLook = 64, kLeastLooks = 128, kMostLooks = 4096;
/// In smaller pictures than this it would be more than a twentieth.
constexpr uint64_t kLeastPixels = 10 * kLeastLooks;
constexpr size_t kLeastLooksSeen = 16;  // fewer say nothing of the picture
constexpr double kLeastPrice = 0.05;    // of a sample of what stands still, even where nothing does
constexpr size_t kLooksPerTask = 64;

class MixedIntegrator : public Integrator {
 public:
  MixedIntegrator(ShotParts& parts, const RenderParams& params, const PixelContext& context)
      : shot_(parts.shot()),
        context_(context),
        params_(params),
        automatic_(params.integrator == IntegratorKind::automatic),
        budget_(static_cast<uint32_t>(std::max(params.spp, automatic_ ? 1 : params.tc_rays))),
        fixed_plan_{static_cast<uint32_t>(params.tc_rays), budget_},
        shading_(shading_options(params)),
        mask_(parts.motion_mask(context.filter.radius())),
        scene_(parts.discrete(params.discrete_keys)),
        backdrops_(!has_still_veil(shot_, context.shader)),
        tracer_(parts.tracer(params.instruction_set, backdrops_)) {
    const bool anything_still =
        std::any_of(shot_.meshes.begin(), shot_.meshes.end(), [](const Mesh& mesh) { return mesh.is_static(); });
    still_layer_is_empty_ = !anything_still && !context.shader.has_sky();
    if (mask_.empty()) return;
    packets_ = choose_packets(context, shot_.projection, tracer_);
    if (!automatic_) return;
    if (params.calibration) {
      prices_ = prices_of(*params.calibration);
    } else {
      const RayWork work = sample_ray_work(context, shot_, mask_, tracer_, shading_);
      prices_ = estimate_prices(work, mean_key_spans(shot_), anything_still, params.shading);
    }
    allotment_ = Allotment(budget_, prices_);
  }

  std::unique_ptr<Worker> make_worker() const override { return std::make_unique<MixedWorker>(*this); }

  void prepare(Monitor& monitor, RenderStats& stats) override {
    if (automatic_ && !mask_.empty()) stats.prices = prices_;
    if (!spreads_samples(params_)) return;
    const Projection& frame = shot_.projection;
    const uint64_t pixels = static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
    if (pixels < kLeastPixels) return;
    const auto count = static_cast<uint32_t>(std::clamp<uint64_t>(pixels / kPixelsPerLook, kLeastLooks, kMostLooks));
    const Sampler places(SamplerKind::owen_sobol, count, 0);
    struct Look {
      PixelLook pixel;
      int x = 0, y = 0;
      bool tc_possible = false;
    };
    std::vector<Look> looks(count);
    std::mutex mutex;  // of stats
    parallel_for(count, kLooksPerTask, [&](size_t begin, size_t end) {
      MixedWorker worker(*this);
      for (size_t i = begin; i < end; ++i) {
        const SamplePoint place = places.point(places.pixel(0, 0), static_cast<uint32_t>(i));
        Look& look = looks[i];
        look.x = static_cast<int>(place.x * static_cast<float>(frame.width));
        look.y = static_cast<int>(place.y * static_cast<float>(frame.height));
        look.tc_possible = worker.begin_pixel(look.x, look.y, monitor).tc_rays > 0;
        look.pixel = worker.look_at(look.x, look.y, monitor);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      worker.add_ray_counts(stats);
    });
    // What discrete samples are worth in the pixels that could have time-continuous rays instead, and then the rule for
    // those that do not.
    std::vector<PixelLook> all, rivals, discrete;
    for (const Look& look : looks) {
      all.push_back(look.pixel);
      if (look.tc_possible) rivals.push_back(look.pixel);
    }
    const uint32_t first = first_samples(budget_), most = most_samples(budget_);
    if (automatic_)
      allotment_ = Allotment(budget_, prices_, SampleSpread(first, most, budget_, all).gain(budget_, rivals));
    for (const Look& look : looks)
      if (!look.tc_possible || plan(look.x, look.y).tc_rays == 0) discrete.push_back(look.pixel);
    if (discrete.size() >= kLeastLooksSeen) spread_.emplace(first, most, budget_, discrete);
  }

  const Tracer& tracer() const { return tracer_; }

 private:
  /// For a pixel in which things move.
  PixelPlan plan(int x, int y) const {
    if (!automatic_) return fixed_plan_;
    if (!still_layer_is_empty_ && budget_ < kLeastForStill) return {0, budget_};
    return allotment_.plan(mask_.speed(x, y), dither(x, y));
  }

  /// Of a discrete sample, where nothing moves and where something does.
  double sample_price(DiscreteLayer layer) const {
    return layer == DiscreteLayer::all ? 1 : std::clamp(prices_.still_ray, kLeastPrice, 1.0);
  }

  class MixedWorker : public Worker {
   public:
    explicit MixedWorker(const MixedIntegrator& integrator)
        : integrator_(integrator),
          context_(integrator.context_),
          shading_(context_.shader, integrator.shading_),
          still_layer_(context_, integrator.scene_),
          samples_(context_, integrator.scene_),
          contrast_(integrator.shot_.background) {}

    void render_pixel(int x, int y, RaySink& sink, Monitor& monitor) override {
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      const PixelPlan plan = begin_pixel(x, y, monitor);
      const bool moves = integrator_.mask_.moves(x, y);
      moving_pixels_ += moves;
      if (plan.tc_rays > 0) {
        ++tc_pixels_;
        return render_moving(x, y, pixel, plan, sink, monitor);
      }
      const DiscreteLayer layer = moves ? DiscreteLayer::all : DiscreteLayer::still;
      render_discrete(x, y, pixel, layer, sink, monitor);
    }

    /// What a pixel's first samples say.
    PixelLook look_at(int x, int y, Monitor& monitor) {
      const DiscreteLayer layer = integrator_.mask_.moves(x, y) ? DiscreteLayer::all : DiscreteLayer::still;
      contrast_.begin_pixel(nullptr);
      samples_.take(x, y, context_.sampler.pixel(x, y), 0, first_samples(integrator_.budget_), layer, contrast_,
                    monitor);
      return {contrast_.square(), integrator_.sample_price(layer)};
    }

    /// What the pixel gets.
    PixelPlan begin_pixel(int x, int y, Monitor& monitor) {
      if (!integrator_.mask_.moves(x, y)) return {};
      const PixelPlan plan = integrator_.plan(x, y);
      if (plan.tc_rays == 0) return {};
      align_ = align_points(integrator_.mask_, x, y);
      still_layer_.begin_pixel(x, y, context_.sampler.pixel(x, y), align_);
      if (has_still_edge_in_front(x, y, monitor)) return {};
      return plan;
    }

    void add_counts(RenderStats& stats) const override {
      add_ray_counts(stats);
      stats.moving_pixels += moving_pixels_;
      stats.tc_pixels += tc_pixels_;
    }

    void add_ray_counts(RenderStats& stats) const {
      stats.counters += workspace_.counters();
      stats.rays += workspace_.counters().rays + samples_.ray_count() + still_layer_.ray_count();
      stats.segments += workspace_.counters().segments + samples_.hit_count();
      stats.shading_samples += shading_.evaluations() + samples_.hit_count() + still_layer_.evaluations();
    }

   private:
    /// Where something that stands still covers a part of the pixel in front of what moves, its outline is the noise,
    /// and more rays are better than exact ones.
    bool has_still_edge_in_front(int x, int y, Monitor& monitor) {
      if (!integrator_.automatic_ || integrator_.still_layer_is_empty_) return false;
      const uint32_t probes = probe_rays(integrator_.budget_);
      const uint32_t in_front = still_layer_.count_nearer(probes, integrator_.mask_.depth(x, y), monitor);
      return in_front > 0 && in_front < probes;
    }

    /// Discrete samples over pixel and shutter: as many as the pixel needs, each time twice what there are.
    void render_discrete(int x, int y, const Sampler::Pixel& pixel, DiscreteLayer layer, RaySink& sink,
                         Monitor& monitor) {
      const std::optional<SampleSpread>& spread = integrator_.spread_;
      if (!spread) return samples_.take(x, y, pixel, 0, integrator_.budget_, layer, sink, monitor);
      contrast_.begin_pixel(&sink);
      uint32_t taken = first_samples(integrator_.budget_);
      samples_.take(x, y, pixel, 0, taken, layer, contrast_, monitor);
      while (taken < spread->count(contrast_.square())) {
        samples_.take(x, y, pixel, taken, 2 * taken, layer, contrast_, monitor);
        taken *= 2;
      }
    }

    void render_moving(int x, int y, const Sampler::Pixel& pixel, const PixelPlan& plan, RaySink& sink,
                       Monitor& monitor) {
      shaded_.clear();
      rays_.clear();
      double still = 0;
      constexpr uint32_t kMostRays = Tracer::kMaxPacket;
      for (uint32_t begin = 0; begin < plan.tc_rays; begin += kMostRays) {
        if (begin % kRaysPerPoll == 0) monitor.poll();
        const uint32_t size = std::min(kMostRays, plan.tc_rays - begin);
        for (uint32_t i = 0; i < size; ++i) {
          const SamplePoint point = align_(context_.sampler.point(pixel, begin + i));
          batch_[i] = context_.ray(x, y, point);
          times_[i] = point.time;
        }
        std::span<const Segment> backdrops;
        if (integrator_.backdrops_) backdrops = still_layer_.backdrops(begin, size, monitor);
        const std::span<const Ray> rays = std::span(batch_).first(size);
        const auto seen = integrator_.tracer_.trace_packet(rays, Visibility::visible, workspace_, backdrops,
                                                           integrator_.packets_.together(plan.tc_rays));
        parts_.clear();
        ends_.clear();
        shading_.shade({rays, seen, std::span(times_).first(size), pixel.seed, begin}, parts_, ends_);
        for (uint32_t i = 0; i < size; ++i) {
          const size_t first = shaded_.size(), first_part = i == 0 ? 0 : ends_[i - 1];
          still += append_with_background(std::span(parts_).subspan(first_part, ends_[i] - first_part));
          rays_.push_back(
              {first, shaded_.size(), static_cast<uint32_t>(seen[i].segments.size() + seen[i].veils.size())});
        }
      }
      if (still > 0 && !integrator_.still_layer_is_empty_) {
        const uint32_t count =
            integrator_.automatic_ ? still_rays(plan, still / plan.tc_rays) : std::max(plan.tc_rays, plan.discrete);
        if (count > plan.tc_rays) correct_still_parts(plan.tc_rays, count, monitor);
      }
      for (const RayParts& ray : rays_)
        sink.add({ShadedRay::Kind::tc, std::span(shaded_).subspan(ray.begin, ray.end - ray.begin), ray.segments});
    }

    /// Adds S - S' above. The still layer is looked at when it is seen: at instants spread over the time in which the
    /// pixel's time-continuous rays see it, so that a colour that changes with time is weighted as it should be.
    void correct_still_parts(uint32_t own, uint32_t all, Monitor& monitor) {
      collect_still_time();
      const LayerLook correction =
          still_layer_.difference(own, all, monitor, [&](float place) { return still_time(place); });
      for (ShadedSegment& part : shaded_)
        if (is_still(part)) add_to(part, correction);
    }

    bool is_still(const ShadedSegment& part) const {
      return part.mesh == kNoMesh || integrator_.shot_.meshes[part.mesh].is_static();
    }

    /// Appends a ray's parts, with segments of background in their gaps; returns how long it sees what is still.
    double append_with_background(std::span<const ShadedSegment> parts) {
      double still = 0;
      float from = 0;
      const auto fill_until = [&](float time) {
        if (time <= from) return;
        ShadedSegment gap{from, time, INFINITY, INFINITY, integrator_.shot_.background, {}, {}, kNoMesh, 0};
        gap.coverage = 0;
        shaded_.push_back(gap);
        still += time - from;
      };
      for (const ShadedSegment& part : parts) {
        fill_until(part.begin);
        from = part.end;
        if (is_still(part)) still += part.end - part.begin;
        shaded_.push_back(part);
      }
      fill_until(1);
      return still;
    }

    /// The stretches in which the pixel's rays see what is still, one after the other, with the running sum of
    /// durations.
    void collect_still_time() {
      stretches_.clear();
      double sum = 0;
      for (const ShadedSegment& part : shaded_)
        if (is_still(part)) {
          sum += static_cast<double>(part.end) - static_cast<double>(part.begin);
          stretches_.push_back({part.begin, part.end, sum});
        }
    }
    /// The instant at the share `place`, 0 to 1, of these stretches.
    float still_time(float place) const {
      const double wanted = static_cast<double>(place) * stretches_.back().sum;
      const auto at = std::lower_bound(stretches_.begin(), stretches_.end(), wanted,
                                       [](const Stretch& stretch, double value) { return stretch.sum < value; });
      const Stretch& stretch = at == stretches_.end() ? stretches_.back() : *at;
      return std::clamp(stretch.end - static_cast<float>(stretch.sum - wanted), stretch.begin, stretch.end);
    }

    static void add_to(ShadedSegment& part, const LayerLook& correction) {
      part.colour += correction.colour;
      part.normal += correction.normal;
      part.albedo += correction.albedo;
      part.coverage += correction.coverage;
    }

    struct RayParts {
      size_t begin, end;  // of shaded_
      uint32_t segments;
    };
    struct Stretch {
      float begin, end;
      double sum;
    };

    const MixedIntegrator& integrator_;
    const PixelContext& context_;
    Tracer::Workspace workspace_;
    PacketShading shading_;
    std::vector<ShadedSegment> parts_;   // of a packet's rays
    std::vector<size_t> ends_;           // [ray]: of its part of parts_
    std::vector<ShadedSegment> shaded_;  // of all of a pixel's time-continuous rays
    std::vector<RayParts> rays_;
    std::vector<Stretch> stretches_;
    AlignedPoints align_;  // of the pixel's time-continuous rays
    StillLayer still_layer_;
    DiscreteSamples samples_;
    ContrastSink contrast_;
    std::array<Ray, kRaysPerPoll> batch_;
    std::array<float, kRaysPerPoll> times_{};
    uint64_t moving_pixels_ = 0, tc_pixels_ = 0;
  };

  const Shot& shot_;
  const PixelContext& context_;
  RenderParams params_;
  bool automatic_;                      // plan per pixel
  uint32_t budget_;                     // samples of a pixel
  PixelPlan fixed_plan_;                // else
  Allotment allotment_{1, {}};          // of the budget, where things move
  std::optional<SampleSpread> spread_;  // of pixels with discrete samples alone; unset: all get the budget
  ShadingOptions shading_;
  const MotionMask& mask_;
  const DiscreteScene& scene_;
  bool backdrops_;  // are still rays traced first, as backdrops?
  const Tracer& tracer_;
  bool still_layer_is_empty_ = false;  // but for a background that is the same everywhere
  PacketChoice packets_;
  RayPrices prices_;
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
