// What rays cost in a shot, and the counts from which `auto` estimates that where nobody has measured: what
// bench/fit_prices.py fits one to the other by.
//
// usage: bench_prices SCENE... [--size WxH] [--frame F] [--shutter OPEN,CLOSE] [--camera NAME] [--instances WHICH]
//                     [--csv FILE]
//
// With normals; one thread, processor time. For the CSV file: discrete_ns of a sample where something moves, for 4, 16
// and 64 in a pixel; where nothing does, resting_ns of one of 64, and resting_all_ns of one that asks for what moves,
// too; still_ns and, for 1, 4 and 16 in a pixel, tc_ns (see Calibration); for as many, and with 0 for rays of a
// sixteenth of the shutter (see WorkSample), nodes, triangles, solves, hits, segments, evaluations and layers of a ray;
// placed and seen (see SampleWork), and resting_seen, the same where nothing moves; anything_still, 0 or 1, and
// moving_trees: see Surroundings.
#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/parallel.h"
#include "integrators/shot_parts.h"
#include "measuring.h"
#include "policy/ray_prices.h"
#include "render/measure_rays.h"
#include "reported_run.h"
#include "shot_choice.h"

namespace kairos::bench {
namespace {

void measure(const Shot& shot, Rows& rows) {
  ShotParts parts(shot);
  RenderParams params;
  params.shading = ShadingKind::normal;
  Monitor monitor(2 * kMeasuringSteps);
  const Calibration costs = measure_rays(parts, params, monitor);
  rows.add("discrete_ns", 64, 0, costs.discrete_sample);
  constexpr int kRounds = 5;
  const auto add_samples = [&](const char* measure, IntegratorKind kind, int samples, bool moving) {
    const MeasuredWay way{kind, 1, samples};
    for (const double pixel : measure_pixels(parts, params, {&way, 1}, moving, kRounds, monitor))
      rows.add(measure, samples, 0, pixel / samples);
  };
  for (const int samples : {4, 16}) add_samples("discrete_ns", IntegratorKind::qmc, samples, true);
  add_samples("resting_ns", IntegratorKind::mixed, 64, false);
  add_samples("resting_all_ns", IntegratorKind::qmc, 64, false);
  rows.add("still_ns", costs.still_ray);
  for (size_t i = 0; i < Calibration::kRays.size(); ++i) rows.add("tc_ns", Calibration::kRays[i], 0, costs.tc_ray[i]);

  const PixelContext context{CameraRays(shot.projection), Sampler(params.sampler, Tracer::kMaxPacket, params.seed),
                             PixelFilter(params.filter), parts.shader(params.shading, false, params.max_depth, 0, true),
                             shot.seen_background()};
  // As auto does, but for surfaces that let light through.
  const Tracer& tracer = parts.tracer(std::nullopt, true);
  const MotionMask& mask = parts.motion_mask(context.filter.radius(), std::nullopt);
  const WorkSample work =
      sample_ray_work(context, shot, mask, tracer, &parts.discrete(0), choose_packets(context, shot.projection, tracer),
                      shading_options(shot, params, context.needs));
  int resting = 0, resting_seen = 0;
  for (const LookPixel& at : look_pixels(shot.projection)) {
    if (mask.moves(at.x, at.y)) continue;
    const Ray ray = context.ray(at.x, at.y, {0.5f, 0.5f, 0.5f});
    constexpr float kTime = 0.5f;
    std::optional<DiscreteHit> hit;
    parts.discrete(0).intersect({&ray, 1}, {&kTime, 1}, {&hit, 1}, DiscreteLayer::still);
    ++resting;
    resting_seen += hit.has_value();
  }
  rows.add("resting_seen", static_cast<double>(resting_seen) / std::max(1, resting));
  const auto add = [&](int rays, const RayWork& of) {
    rows.add("nodes", rays, 0, of.nodes);
    rows.add("triangles", rays, 0, of.triangles);
    rows.add("solves", rays, 0, of.root_solves);
    rows.add("hits", rays, 0, of.hits);
    rows.add("segments", rays, 0, of.segments);
    rows.add("evaluations", rays, 0, of.evaluations);
    rows.add("layers", rays, 0, of.layers);
  };
  add(0, work.sample.instant);
  rows.add("placed", work.sample.placed);
  rows.add("seen", work.sample.seen);
  for (size_t i = 0; i < Calibration::kRays.size(); ++i) add(Calibration::kRays[i], work.tc[i]);
  const Surroundings around(shot, parts.discrete(0), context.shader, params.shading, 64);
  rows.add("anything_still", around.anything_still);
  rows.add("moving_trees", static_cast<double>(around.moving_trees));
}

int run(int argc, char** argv) {
  CLI::App app("What rays cost, and the counts of their work");
  const ShotChoice choice(app, "960x540");
  std::string csv;
  app.add_option("--csv", csv, "The file to write; standard output, if not given");
  CLI11_PARSE(app, argc, argv);
  Rows rows(csv);
  with_threads(1, [&] { measure(choice.make(false), rows); });
  return 0;
}

}  // namespace
}  // namespace kairos::bench

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_prices", kairos::bench::run, argc, argv); }
