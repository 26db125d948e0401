#include "integrators/shadow_choice.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/parallel.h"
#include "integrators/mixed_worker.h"
#include "policy/duel.h"
#include "policy/shadow_prices.h"
#include "policy/shadow_race.h"

namespace kairos {

namespace {

// Pixels looked at for shadows that pass: one in so many, within limits.
constexpr size_t kPixelsPerShadowLook = 64, kLeastShadowLooks = 128, kMostShadowLooks = 512;
constexpr size_t kMostMirrorLooks = 2048;  // what mirrors show often covers little of a picture
constexpr size_t kMostRacing = 96;         // of those in which any does: the error of so many is known to about 1 dB
constexpr size_t kPixelsPerTask = 8;
/// Exact looks are to take about so much of the time of the still rays beside them: half as many leave 3 dB more noise
/// in the shadow of a fan, a quarter 10 dB more.
constexpr double kShareOfTime = 0.5;
constexpr double kMostStillRaysPerExact = 16;
/// Of what mirrors show, which has edges, unlike shadows: a quarter as many rays leave 9 dB more noise.
constexpr double kMostStillRaysPerMirrored = 4;
/// What passes in mirrors covers few pixels, some of which have most of the error: that their sum is half is enough.
constexpr double kFarSmaller = 0.5;

bool is_any(const std::vector<bool>& meshes) { return std::find(meshes.begin(), meshes.end(), true) != meshes.end(); }

bool may_be_exact(const RenderParams& params, const ShadingOptions& options) {
  return is_lit(params.shading) && params.shadows != Shadows::sampled && options.clusters == Clusters::pixel;
}

size_t pixels_of(const MixedFrame& frame) {
  const Projection& projection = frame.shot.projection;
  return static_cast<size_t>(projection.width) * static_cast<size_t>(projection.height);
}

/// What a few exact looks into pixels in which nothing moves have found.
struct Passing {
  std::vector<LookPixel> pixels;  // in which something passes before a light
  double time = 0;                // nanoseconds of an exact look there, in the mean
};

Passing find_passing(const MixedFrame& frame, Monitor& monitor) {
  std::vector<LookPixel> places = look_pixels(frame.shot.projection);
  const size_t most = frame.resting_mirrors ? kMostMirrorLooks : kMostShadowLooks;
  const size_t wanted = std::clamp(pixels_of(frame) / kPixelsPerShadowLook, kLeastShadowLooks, most);
  places.resize(std::min(places.size(), wanted));
  std::erase_if(places, [&](const LookPixel& at) { return frame.is_over_time(at.x, at.y); });
  std::vector<double> times(places.size());
  parallel_for(places.size(), kPixelsPerTask, [&](size_t begin, size_t end) {
    MixedWorker worker(frame);
    for (size_t i = begin; i < end; ++i) times[i] = worker.passing_shadow_time(places[i].x, places[i].y, monitor);
  });
  Passing passing;
  for (size_t i = 0; i < places.size(); ++i) {
    if (!(times[i] > 0)) continue;
    passing.pixels.push_back(places[i]);
    passing.time += times[i];
  }
  if (!passing.pixels.empty()) passing.time /= static_cast<double>(passing.pixels.size());
  return passing;
}

/// Do exact shadows and mirrors have clearly the smaller product of error and time?
bool exact_wins(const MixedFrame& frame, std::vector<LookPixel> pixels, Monitor& monitor) {
  pixels.resize(std::min(pixels.size(), kMostRacing));
  std::vector<MixedWorker::ShadowRace> runs(pixels.size());
  parallel_for(pixels.size(), kPixelsPerTask, [&](size_t begin, size_t end) {
    MixedWorker worker(frame);
    for (size_t i = begin; i < end; ++i) runs[i] = worker.race_shadows(pixels[i].x, pixels[i].y, monitor);
  });
  Duel duel;
  for (const auto& run : runs) duel.add(run.exact, run.sampled);
  const bool is_far_smaller =
      duel.pixels() >= Duel::kLeastPixels && duel.mean_ours() < kFarSmaller * duel.mean_theirs();
  return duel.is_won() || (frame.resting_mirrors && is_far_smaller);
}

}  // namespace

std::vector<bool> choose_exact_shadows(const PixelContext& context, const Shot& shot, const RenderParams& params,
                                       const Tracer& tracer, const DiscreteScene& scene, const ShadingOptions& options,
                                       uint32_t rays_in_pixel) {
  // Colours free of noise change by what changes in the scene alone: where that is shadows, they are steps.
  if (context.needs.contrast > 0)
    return params.shadows == Shadows::sampled ? std::vector<bool>() : context.shader.resting_receivers();
  if (!may_be_exact(params, options)) return {};
  std::vector<bool> meshes = context.shader.resting_receivers();
  if (is_any(meshes) && params.shadows == Shadows::automatic)
    meshes = race_shadows(context, shot, params.shading, tracer, scene, options, rays_in_pixel, std::move(meshes));
  return is_any(meshes) ? meshes : std::vector<bool>();
}

std::vector<bool> choose_exact_mirrors(const PixelContext& context, const RenderParams& params,
                                       const ShadingOptions& options) {
  if (params.mirrors == Mirrors::sampled || options.contrast > 0 || options.clusters != Clusters::pixel) return {};
  std::vector<bool> meshes = context.shader.resting_mirrors();
  return is_any(meshes) ? meshes : std::vector<bool>();
}

void choose_shadows(MixedFrame& frame, Monitor& monitor) {
  const bool all_rests = std::all_of(frame.shot.meshes.begin(), frame.shot.meshes.end(),
                                     [](const Mesh& mesh) { return mesh.is_static(); });
  if (all_rests) return;
  const bool shadows = may_be_exact(frame.params, frame.shading) && is_any(frame.context.shader.resting_receivers());
  frame.plan.exact_mirrors = choose_exact_mirrors(frame.context, frame.params, frame.shading);
  if (!shadows && frame.plan.exact_mirrors.empty()) return;
  // In smaller pictures looks would take more than they could save.
  const bool leaves_open = frame.params.shadows != Shadows::exact && frame.params.mirrors != Mirrors::exact;
  if (leaves_open && pixels_of(frame) < 10 * kLeastShadowLooks) return;
  const bool may_trace = shadows && !frame.mask.empty() && (!frame.automatic || frame.plan.allotment.buys_tc());
  if (may_trace)
    frame.plan.exact_shadows = choose_exact_shadows(frame.context, frame.shot, frame.params, frame.tracer, frame.scene,
                                                    frame.shading, frame.tc_rays());
  uint32_t& per_exact = frame.plan.still_rays_per_exact;
  per_exact = 1;
  frame.use_shadows();
  const Passing passing = find_passing(frame, monitor);
  const double dearer = passing.time / (kShareOfTime * lit_sample_time(frame.shot, frame.params.shading));
  const double most = frame.resting_mirrors ? kMostStillRaysPerMirrored : kMostStillRaysPerExact;
  per_exact = std::bit_ceil(static_cast<uint32_t>(std::clamp(dearer, 1.0, most)));
  if (leaves_open && !exact_wins(frame, passing.pixels, monitor)) per_exact = 0;
  frame.use_shadows();
}

}  // namespace kairos
