#include "integrators/mixed_frame.h"

#include <algorithm>
#include <cmath>

#include "math/hash.h"
#include "policy/shadow_prices.h"

namespace kairos {

namespace {

// Tell random numbers of different uses from each other.
constexpr uint64_t kShareSeed = 0x5741;
constexpr uint64_t kRaceSeed = 0x5261;

/// A blended surface that stands still hides nothing, so it is no occluder hint, and is traced with what moves.
bool has_still_blended(const Shot& shot, const Shader& shader) {
  for (uint32_t m = 0; m < shot.meshes.size(); ++m)
    if (shot.meshes[m].is_static() && shader.cut_outs() && shader.cut_outs()->is_blended(m)) return true;
  return false;
}

bool has_mesh_that_shows_others(const Shot& shot, const Shader& shader) {
  for (uint32_t m = 0; m < shot.meshes.size(); ++m)
    if (shader.shows_others(m)) return true;
  return false;
}

}  // namespace

MixedFrame::MixedFrame(ShotParts& parts, const RenderParams& render_params, const PixelContext& pixel_context)
    : shot(parts.shot()),
      context(pixel_context),
      params(render_params),
      automatic(params.integrator == IntegratorKind::automatic),
      budget(static_cast<uint32_t>(std::max(params.spp, automatic ? 1 : params.tc_rays))),
      fixed_plan{static_cast<uint32_t>(params.tc_rays), budget},
      share_points(SamplerKind::owen_sobol, kShareRays, hash(params.seed, kShareSeed)),
      race_points{Sampler(params.sampler, context.sampler.count(), hash(params.seed, kRaceSeed, 0)),
                  Sampler(params.sampler, context.sampler.count(), hash(params.seed, kRaceSeed, 1))},
      shading(shading_options(parts.shot(), params, context.needs)),
      mask(parts.motion_mask(context.filter.radius(), params.crop)),
      scene(parts.discrete(params.discrete_keys)),
      occluder_hints(!has_still_blended(shot, context.shader)),
      tracer(parts.tracer(params.instruction_set, occluder_hints)),
      surroundings(shot, scene, context.shader, params.shading, budget),
      still_layer_is_empty(!surroundings.still_layer),
      any_shows_others(has_mesh_that_shows_others(shot, context.shader)) {}

// Time-continuous rays of `auto` cost about as many discrete samples as they are shaded.
double MixedFrame::look_ups() const { return automatic ? budget : params.tc_rays * shading.samples; }

uint32_t MixedFrame::tc_rays() const {
  return automatic ? static_cast<uint32_t>(std::lround(std::max(1.0, plan.allotment.mean_rays()))) : fixed_plan.tc_rays;
}

void MixedFrame::use_cells() { cells = plan_cells(shot, params, plan.cells, look_ups()); }

void MixedFrame::price_shared_light() {
  if (!plan.cells) return;
  constexpr double kLookUp = 200;  // nanoseconds, of finding its cell
  surroundings.light = (surroundings.light + weighing_time(shot)) * plan.cells->rate + kLookUp;
  if (!automatic || params.calibration || (mask.empty() && context.needs.time != RecordNeeds::Time::segments)) return;
  plan.prices = estimate_prices(plan.work, surroundings);
  plan.allotment = Allotment(budget, plan.prices);
}

void MixedFrame::estimate() {
  if (mask.empty() && context.needs.time != RecordNeeds::Time::segments) return;
  plan.packets = choose_packets(context, shot.projection, tracer);
  if (!automatic) return;
  plan.work = sample_ray_work(context, shot, mask, tracer, occluder_hints ? &scene : nullptr, plan.packets, shading);
  plan.prices = params.calibration ? prices_of(*params.calibration) : estimate_prices(plan.work, surroundings);
  plan.allotment = Allotment(budget, plan.prices);
}

void MixedFrame::use_shadows() {
  tc_shadows.reset();
  resting_shadows.reset();
  if (!plan.exact_shadows.empty()) tc_shadows.emplace(context.shader, tracer, scene, plan.exact_shadows);
  resting_mirrors.reset();
  if (plan.still_rays_per_exact == 0) return;
  std::vector<bool> receivers =
      params.shadows == Shadows::sampled ? std::vector<bool>(shot.meshes.size()) : context.shader.resting_receivers();
  if (!plan.exact_mirrors.empty()) {
    resting_mirrors.emplace(context.shader, tracer, scene, plan.exact_mirrors);
    for (size_t m = 0; m < receivers.size(); ++m) receivers[m] = receivers[m] && !plan.exact_mirrors[m];
  }
  resting_shadows.emplace(context.shader, tracer, scene, std::move(receivers));
}

ShadingOptions MixedFrame::tc_shading() const {
  ShadingOptions options = shading;
  if (tc_shadows) options.shadows = &*tc_shadows;
  return options;
}

PixelPlan MixedFrame::plan_pixel(int x, int y) const {
  if (!automatic) return fixed_plan;
  if (context.needs.over_time()) return plan.allotment.plan_over_time(dither(x, y));
  if (will_race) return plan.allotment.plan_over_time(dither(x, y));
  if (plan.race) {
    const Allotment* winner = plan.race->winner(speed(x, y));
    return winner != nullptr ? winner->plan_over_time(dither(x, y)) : PixelPlan{0, budget};
  }
  if (!still_layer_is_empty && budget < kLeastForStill) return {0, budget};
  return plan.allotment.plan(speed(x, y), dither(x, y));
}

double MixedFrame::raced_rays() const {
  return Allotment(budget, still_layer_is_empty ? plan.prices : without_shares(plan.prices), 1, 0).mean_rays();
}

}  // namespace kairos
