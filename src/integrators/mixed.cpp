// Time-continuous rays for what moves, discrete rays for what stands still, in one pixel. docs/method.md, "Static and
// moving in one pixel".
//
// Let L_k be what time-continuous ray k sees. Still rays are cheap, so there are more of them. With their mean S and
// the mean S' over those that lie on the time-continuous rays' own places, the control variate
//   I = mean_k(L_k) + B (S - S')
// takes from the still layer (background included) the noise of the few rays and puts in that of the many, if B is
// about the share of the shutter in which it is seen. B must know nothing of the rays k: W_k, the share that ray k
// sees, goes with the colour along it, and I would be biased. Its second term is handed on as a term of its own,
// PixelRecord::still.
#include <mutex>

#include <kairos/picture.h>

#include "base/parallel.h"
#include "discrete/discrete_scene.h"
#include "integrators/contrast.h"
#include "integrators/discrete_samples.h"
#include "integrators/frame_plan.h"
#include "integrators/integrator.h"
#include "integrators/packet_choice.h"
#include "integrators/still_layer.h"
#include "math/hash.h"
#include "motion/aligned_points.h"
#include "motion/motion_mask.h"
#include "policy/allotment.h"
#include "policy/sample_spread.h"
#include "shading/packet_shading.h"

namespace kairos {

namespace {

/// A blended surface that stands still hides nothing, so it is no occluder hint, and is traced with what moves.
bool has_still_blended(const Shot& shot, const Shader& shader) {
  for (uint32_t m = 0; m < shot.meshes.size(); ++m)
    if (shot.meshes[m].is_static() && shader.cut_outs() && shader.cut_outs()->is_blended(m)) return true;
  return false;
}

/// Pixels in which the picture is looked at beforehand, for where samples are needed: it takes
/// about a hundredth of the time.
constexpr uint64_t kPixelsPerLook = 64, kLeastLooks = 128, kMostLooks = kMostLookPixels;
/// In smaller pictures than this it would be more than a twentieth.
constexpr uint64_t kLeastPixels = 10 * kLeastLooks;
constexpr size_t kLeastLooksSeen = 16;  // fewer say nothing of the picture
constexpr double kLeastPrice = 0.05;    // of a sample of what stands still, even where nothing does
constexpr size_t kLooksPerTask = 64;

/// By which the share of the still layer is found: a twentieth of the time of four time-continuous rays.
constexpr uint32_t kShareRays = 4;
constexpr uint64_t kShareSeed = 0x5741;  // tells their random numbers from those of other rays

/// One in so many of the pixels looked at is raced in: four times the budget each, so a fiftieth of the picture's time.
constexpr size_t kLooksPerRace = 3;
constexpr uint64_t kRaceSeed = 0x5261;

class MixedIntegrator : public Integrator {
 public:
  MixedIntegrator(ShotParts& parts, const RenderParams& params, const PixelContext& context)
      : shot_(parts.shot()),
        context_(context),
        params_(params),
        automatic_(params.integrator == IntegratorKind::automatic),
        budget_(static_cast<uint32_t>(std::max(params.spp, automatic_ ? 1 : params.tc_rays))),
        fixed_plan_{static_cast<uint32_t>(params.tc_rays), budget_},
        share_points_(SamplerKind::owen_sobol, kShareRays, hash(params.seed, kShareSeed)),
        race_points_{Sampler(params.sampler, context.sampler.count(), hash(params.seed, kRaceSeed, 0)),
                     Sampler(params.sampler, context.sampler.count(), hash(params.seed, kRaceSeed, 1))},
        shading_(shading_options(parts.shot(), params, context.needs)),
        mask_(parts.motion_mask(context.filter.radius(), params.crop)),
        scene_(parts.discrete(params.discrete_keys)),
        occluder_hints_(!has_still_blended(shot_, context.shader)),
        tracer_(parts.tracer(params.instruction_set, occluder_hints_)),
        parts_(parts),
        key_(plan_key(params, context.needs)) {
    const bool anything_still =
        std::any_of(shot_.meshes.begin(), shot_.meshes.end(), [](const Mesh& mesh) { return mesh.is_static(); });
    still_layer_is_empty_ = !anything_still && !context.shader.has_sky();
    if (const FramePlan* plan = params.exposure ? nullptr : parts.find_plan(key_)) {
      frame_ = *plan;
      known_ = true;
      return;
    }
    if (mask_.empty() && context.needs.time != RecordNeeds::Time::segments) return;
    frame_.packets = choose_packets(context, shot_.projection, tracer_);
    if (!automatic_) return;
    if (params.calibration) {
      frame_.prices = prices_of(*params.calibration);
    } else {
      const RayWork work = sample_ray_work(context, shot_, mask_, tracer_, shading_);
      frame_.prices = estimate_prices(work, mean_key_spans(shot_), anything_still, params.shading);
    }
    frame_.allotment = Allotment(budget_, frame_.prices);
  }

  std::unique_ptr<Worker> make_worker() const override { return std::make_unique<MixedWorker>(*this); }

  void prepare(Monitor& monitor, RenderStats& stats) override {
    if (automatic_ && !mask_.empty()) stats.prices = frame_.prices;
    if (known_) return;
    look_around(monitor, stats);
    if (!params_.exposure) parts_.keep_plan(key_, frame_);  // the key does not know exposures
  }

  const Tracer& tracer() const { return tracer_; }

 private:
  /// Looks at pixels all over the frame, for where samples are needed.
  void look_around(Monitor& monitor, RenderStats& stats) {
    if (!spreads_samples(params_)) return;
    const Projection& frame = shot_.projection;
    const uint64_t pixels = static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
    if (pixels < kLeastPixels) return;
    will_race_ = automatic_ && is_lit(params_.shading) && !context_.needs.over_time();
    const auto count = static_cast<uint32_t>(std::clamp<uint64_t>(pixels / kPixelsPerLook, kLeastLooks, kMostLooks));
    const std::vector<LookPixel> places = look_pixels(frame);
    struct Look {
      PixelLook pixel;
      int x = 0, y = 0;
      bool tc_possible = false;
      double still_rays = 0;  // beside them, as a share of the budget
    };
    std::vector<Look> looks(count);
    std::mutex mutex;  // of stats
    parallel_for(count, kLooksPerTask, [&](size_t begin, size_t end) {
      MixedWorker worker(*this);
      for (size_t i = begin; i < end; ++i) {
        Look& look = looks[i];
        look.x = places[i].x;
        look.y = places[i].y;
        look.tc_possible = worker.begin_pixel(look.x, look.y, monitor).tc_rays > 0;
        look.pixel = worker.look_at(look.x, look.y, monitor);
        if (will_race_ && look.tc_possible) look.still_rays = worker.still_rays_share(look.x, look.y);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      worker.add_ray_counts(stats);
    });
    // What discrete samples are worth in the pixels that could have time-continuous rays instead, and then the rule for
    // those that do not.
    std::vector<PixelLook> all, rivals, discrete;
    double still_rays = 0;
    for (const Look& look : looks) {
      all.push_back(look.pixel);
      if (look.tc_possible) rivals.push_back(look.pixel);
      still_rays += look.still_rays;
    }
    const uint32_t first = first_samples(budget_), most = most_samples(budget_);
    if (automatic_) {
      const double gain = SampleSpread(first, most, budget_, all).gain(budget_, rivals);
      const double still_share = will_race_ && !rivals.empty() ? still_rays / static_cast<double>(rivals.size()) : 1;
      frame_.allotment = Allotment(budget_, frame_.prices, gain, still_share);
      if (will_race_ && frame_.allotment.buys_tc()) {
        std::vector<LookPixel> racing;
        for (size_t i = 0; i < looks.size(); i += kLooksPerRace)
          if (looks[i].tc_possible) racing.push_back({looks[i].x, looks[i].y});
        frame_.spread.emplace(first, most, budget_, rivals);
        race(racing, monitor);
        frame_.spread.reset();
      }
      will_race_ = false;
    }
    for (const Look& look : looks)
      if (!look.tc_possible || plan(look.x, look.y).tc_rays == 0) discrete.push_back(look.pixel);
    if (discrete.size() >= kLeastLooksSeen) frame_.spread.emplace(first, most, budget_, discrete);
  }

  /// Rays of races are not counted: they would not be those of the picture.
  void race(const std::vector<LookPixel>& pixels, Monitor& monitor) {
    std::vector<RaceErrors> errors(pixels.size());
    parallel_for(pixels.size(), kLooksPerTask, [&](size_t begin, size_t end) {
      MixedWorker worker(*this);
      for (size_t i = begin; i < end; ++i) errors[i] = worker.race(pixels[i].x, pixels[i].y, monitor);
    });
    Race& race = frame_.race.emplace();
    for (size_t i = 0; i < pixels.size(); ++i)
      race.add(speed(pixels[i].x, pixels[i].y), errors[i].tc, errors[i].discrete);
  }

  /// Pixels that something moves by while this one looks.
  double speed(int x, int y) const { return mask_.speed(x, y) * static_cast<double>(context_.times(x, y).duration()); }

  /// May a pixel get time-continuous rays? Who needs exact segments needs them everywhere.
  bool is_over_time(int x, int y) const {
    return context_.needs.time == RecordNeeds::Time::segments || mask_.moves(x, y);
  }
  /// For such a pixel.
  PixelPlan plan(int x, int y) const {
    if (!automatic_) return fixed_plan_;
    if (context_.needs.over_time()) return frame_.allotment.plan_over_time(dither(x, y));
    if (!still_layer_is_empty_ && budget_ < kLeastForStill) return {0, budget_};
    if (will_race_) return frame_.allotment.plan_over_time(dither(x, y));
    if (frame_.race)
      return frame_.race->tc_wins(speed(x, y)) ? frame_.allotment.plan_over_time(dither(x, y)) : PixelPlan{0, budget_};
    return frame_.allotment.plan(speed(x, y), dither(x, y));
  }

  /// Of a discrete sample, where nothing moves and where something does.
  double sample_price(DiscreteLayer layer) const {
    return layer == DiscreteLayer::all ? 1 : std::clamp(frame_.prices.still_ray, kLeastPrice, 1.0);
  }

  /// Squared, of a pixel.
  struct RaceErrors {
    double tc = 0, discrete = 0;
  };

  class MixedWorker : public Worker {
   public:
    explicit MixedWorker(const MixedIntegrator& integrator)
        : integrator_(integrator),
          context_(integrator.context_),
          shading_(context_.shader, integrator.shading_),
          still_layer_(context_, integrator.scene_),
          samples_(context_, integrator.scene_),
          contrast_(integrator.shot_.seen_background()),
          record_(context_.needs.surfaces()) {}

    const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override {
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      const PixelPlan plan = begin_pixel(x, y, monitor);
      const bool moves = integrator_.mask_.moves(x, y);
      moving_pixels_ += moves;
      record_.begin_pixel(x, y, context_.background, context_.times(x, y).window());
      record_.set_plan(plan, moves);
      if (plan.tc_rays > 0) {
        ++tc_pixels_;
        render_moving(x, y, pixel, plan, monitor);
      } else {
        render_discrete(x, y, pixel, moves ? DiscreteLayer::all : DiscreteLayer::still, monitor);
      }
      return record_.finish();
    }

    /// What a pixel's first samples say.
    PixelLook look_at(int x, int y, Monitor& monitor) {
      const DiscreteLayer layer = integrator_.mask_.moves(x, y) ? DiscreteLayer::all : DiscreteLayer::still;
      record_.begin_pixel(x, y, context_.background);
      samples_.take(x, y, context_.sampler.pixel(x, y), 0, first_samples(integrator_.budget_), layer, record_, monitor);
      contrast_.begin_pixel();
      contrast_.add(record_, 0);
      return {contrast_.square(), integrator_.sample_price(layer)};
    }

    /// How many still rays a pixel takes beside time-continuous ones, as a share of the budget.
    double still_rays_share(int x, int y) {
      if (integrator_.still_layer_is_empty_) return 0;
      const double share = find_still_share(x, y);
      return share > 0 ? static_cast<double>(still_rays({1, integrator_.budget_}, share)) / integrator_.budget_ : 0;
    }

    /// By both kinds of ray for the same price.
    RaceErrors race(int x, int y, Monitor& monitor) {
      const PixelPlan plan = integrator_.frame_.allotment.plan_over_time(dither(x, y));
      std::array<Vec3f, 2> tc, discrete;
      for (size_t half = 0; half < 2; ++half) {
        const Sampler::Pixel pixel = integrator_.race_points_[half].pixel(x, y);
        const auto begin = [&] { record_.begin_pixel(x, y, context_.background, context_.times(x, y).window()); };
        align_ = align_points(integrator_.mask_, x, y);
        still_layer_.begin_pixel(x, y, pixel, align_);
        begin();
        render_moving(x, y, pixel, plan, monitor);
        tc[half] = reduce(record_.finish(), {}, false).colour;
        begin();
        render_discrete(x, y, pixel, DiscreteLayer::all, monitor);
        discrete[half] = reduce(record_.finish(), {}, false).colour;
      }
      const auto error = [](const std::array<Vec3f, 2>& pair) {
        double sum = 0;  // as a display shows them
        for (int c = 0; c < 3; ++c) {
          const double a = std::clamp(pair[0][c], 0.0f, 1.0f), b = std::clamp(pair[1][c], 0.0f, 1.0f);
          sum += (a - b) * (a - b) / 2;
        }
        return sum;
      };
      return {error(tc), error(discrete)};
    }

    /// What the pixel gets.
    PixelPlan begin_pixel(int x, int y, Monitor& monitor) {
      const PixelPlan discrete{0, integrator_.budget_};
      if (!integrator_.is_over_time(x, y)) return discrete;
      const PixelPlan plan = integrator_.plan(x, y);
      if (plan.tc_rays == 0) return discrete;
      // Of shots that follow on each other, rays are not to jump.
      align_ = context_.needs.over_time() ? AlignedPoints() : align_points(integrator_.mask_, x, y);
      still_layer_.begin_pixel(x, y, context_.sampler.pixel(x, y), align_);
      if (has_still_edge_in_front(x, y, monitor)) return discrete;
      return plan;
    }

    void add_counts(RenderStats& stats) const override {
      add_ray_counts(stats);
      stats.moving_pixels += moving_pixels_;
      stats.tc_pixels += tc_pixels_;
    }

    void add_ray_counts(RenderStats& stats) const {
      stats.counters += workspace_.counters();
      stats.rays += workspace_.counters().rays + samples_.ray_count() + still_layer_.ray_count() + share_rays_;
      stats.segments += workspace_.counters().segments + samples_.hit_count();
      stats.shading_samples += shading_.evaluations() + samples_.hit_count() + still_layer_.evaluations();
    }

   private:
    /// Where something that stands still covers a part of the pixel in front of what moves, its outline is the noise,
    /// and more rays are better than exact ones.
    bool has_still_edge_in_front(int x, int y, Monitor& monitor) {
      if (!integrator_.automatic_ || integrator_.still_layer_is_empty_ || context_.needs.over_time()) return false;
      const uint32_t probes = probe_rays(integrator_.budget_);
      const uint32_t in_front = still_layer_.count_nearer(probes, integrator_.mask_.depth(x, y), monitor);
      return in_front > 0 && in_front < probes;
    }

    /// Discrete samples over pixel and shutter: as many as the pixel needs, each time twice what there are.
    void render_discrete(int x, int y, const Sampler::Pixel& pixel, DiscreteLayer layer, Monitor& monitor) {
      const std::optional<SampleSpread>& spread = integrator_.frame_.spread;
      if (!spread) return samples_.take(x, y, pixel, 0, integrator_.budget_, layer, record_, monitor);
      contrast_.begin_pixel();
      uint32_t taken = first_samples(integrator_.budget_);
      samples_.take(x, y, pixel, 0, taken, layer, record_, monitor);
      contrast_.add(record_, 0);
      while (taken < spread->count(contrast_.square())) {
        samples_.take(x, y, pixel, taken, 2 * taken, layer, record_, monitor);
        contrast_.add(record_, taken);
        taken *= 2;
      }
    }

    void render_moving(int x, int y, const Sampler::Pixel& pixel, const PixelPlan& plan, Monitor& monitor) {
      constexpr uint32_t kMostRays = Tracer::kMaxPacket;
      const PixelTimes times = context_.times(x, y);
      for (uint32_t begin = 0; begin < plan.tc_rays; begin += kMostRays) {
        if (begin % kRaysPerPoll == 0) monitor.poll();
        const uint32_t size = std::min(kMostRays, plan.tc_rays - begin);
        for (uint32_t i = 0; i < size; ++i) {
          const SamplePoint point = align_(context_.sampler.point(pixel, begin + i));
          batch_[i] = context_.ray(x, y, point);
          film_[i] = context_.film(point);
          times_[i] = point.time;
        }
        std::span<const Segment> occluder_hints;
        if (integrator_.occluder_hints_) occluder_hints = still_layer_.occluder_hints(begin, size, monitor);
        const std::span<const Ray> rays = std::span(batch_).first(size);
        const auto seen =
            integrator_.tracer_.trace_packet(rays, Visibility::visible, workspace_, occluder_hints,
                                             integrator_.frame_.packets.together(plan.tc_rays), times.limits());
        ends_.clear();
        uint32_t first = record_.part_count();
        shading_.shade({rays, seen, std::span(times_).first(size), pixel.seed, begin, times.window()}, record_, ends_);
        for (uint32_t i = 0; i < size; ++i) {
          record_.add_ray({film_[i], 1, PixelRay::kAll, first, ends_[i] - first,
                           static_cast<uint32_t>(seen[i].segments.size() + seen[i].blended.size())});
          first = ends_[i];
        }
      }
      if (!integrator_.still_layer_is_empty_) add_still_term(x, y, plan, monitor);
    }

    void add_still_term(int x, int y, const PixelPlan& plan, Monitor& monitor) {
      const double share = find_still_share(x, y);
      if (!(share > 0)) return;
      const uint32_t count = integrator_.automatic_ ? still_rays(plan, share) : std::max(plan.tc_rays, plan.discrete);
      if (count <= plan.tc_rays) return;
      still_layer_.add_rays(count, monitor, record_);
      record_.set_still(plan.tc_rays, static_cast<float>(share));
    }

    /// The share of a few discrete rays, independent of all others, that see what stands still.
    double find_still_share(int x, int y) {
      const Sampler& sampler = integrator_.share_points_;
      const Sampler::Pixel pixel = sampler.pixel(x, y);
      std::array<Ray, kShareRays> rays;
      std::array<float, kShareRays> times{};
      std::array<std::optional<DiscreteHit>, kShareRays> hits;
      const PixelTimes pixel_times = context_.times(x, y);
      for (uint32_t i = 0; i < kShareRays; ++i) {
        const SamplePoint point = sampler.point(pixel, i);
        rays[i] = context_.ray(x, y, point);
        times[i] = pixel_times.instant(point.time);
      }
      integrator_.scene_.intersect(rays, times, hits, DiscreteLayer::all);
      share_rays_ += kShareRays;
      const auto is_still = [&](const auto& hit) { return !hit || integrator_.shot_.meshes[hit->mesh].is_static(); };
      return static_cast<double>(std::count_if(hits.begin(), hits.end(), is_still)) / kShareRays;
    }

    const MixedIntegrator& integrator_;
    const PixelContext& context_;
    Tracer::Workspace workspace_;
    PacketShading shading_;
    std::vector<uint32_t> ends_;  // [ray of a packet]: of its parts
    AlignedPoints align_;         // of the pixel's time-continuous rays
    StillLayer still_layer_;
    DiscreteSamples samples_;
    Contrast contrast_;
    RecordBuilder record_;
    std::array<Ray, Tracer::kMaxPacket> batch_;
    std::array<Vec2f, Tracer::kMaxPacket> film_{};
    std::array<float, Tracer::kMaxPacket> times_{};
    uint64_t moving_pixels_ = 0, tc_pixels_ = 0, share_rays_ = 0;
  };

  const Shot& shot_;
  const PixelContext& context_;
  RenderParams params_;
  bool automatic_;        // plan per pixel
  uint32_t budget_;       // samples of a pixel
  PixelPlan fixed_plan_;  // else
  Sampler share_points_;
  std::array<Sampler, 2> race_points_;
  ShadingOptions shading_;
  const MotionMask& mask_;
  const DiscreteScene& scene_;
  bool occluder_hints_;  // are still rays traced first, as occluder hints?
  const Tracer& tracer_;
  bool still_layer_is_empty_ = false;  // but for a background that is the same everywhere
  ShotParts& parts_;
  PlanKey key_;
  FramePlan frame_;
  bool known_ = false;      // from an earlier picture
  bool will_race_ = false;  // until then any pixel may get time-continuous rays
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
