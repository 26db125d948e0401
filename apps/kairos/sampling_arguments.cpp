#include "sampling_arguments.h"

#include <kairos/error.h>
#include <kairos/names.h>

namespace kairos::cli {

void add_sampling_options(CLI::App& app, SamplingArguments& out) {
  constexpr uint64_t kMostSamples = 1u << 20, kMostShadingSamples = 1u << 16;
  RenderParams& params = out.params;
  add_choice(
      app, "--integrator", params.integrator,
      "tc: time-continuous rays, exact in time; qmc: discrete rays; mixed: tc where anything moves, discrete rays "
      "for what stands still; auto: mixed, rays chosen per pixel for the time of --spp discrete samples");
  add_count(app, "--tc-rays", params.tc_rays, 1, kMostSamples,
            "Rays per pixel of tc, and of mixed where anything moves");
  add_count(app, "--shading-samples", params.shading_samples, 1, kMostShadingSamples,
            "Shading samples per time-continuous ray");
  add_choice(
      app, "--clusters", params.clusters,
      "What is shaded as one. on: triangles that follow on each other smoothly; pixel (auto): a triangle, over a "
      "pixel's rays, or for "
      "lit pictures all that they see; off: nothing");
  add_choice(app, "--shadows", params.shadows,
             "How shadows of point, spot and directional lights are found. exact: in time, wherever surface, light "
             "and camera rest; sampled: at the instants of shading samples; auto: exact where it is worth it");
  add_choice(
      app, "--mirrors", params.mirrors,
      "How it is found what mirrors and panes show of what moves. exact: in time, where they and the camera "
      "rest; sampled: at the instants of shading samples; auto: exact by tc, by mixed and auto where it is worth it");
  add_choice(
      app, "--cells", params.cells,
      "Of lit pictures. on: light that arrives at a cell of a surface counts for all pixels that see it while it "
      "moves; off: each looks for its own; auto: on where all moves as one, but for qmc");
  add_count(app, "--spp", params.spp, 1, kMostSamples,
            "Samples per pixel of qmc; of mixed: discrete rays; of auto: the budget");
  add_choice(app, "--sampler", params.sampler, "Where in the pixel, and when, samples are taken");
  add_choice(app, "--shading", params.shading,
             "normal: |normal| as colour; flat: base colour, unlit; whitted: lit, with shadows, mirrors and glass; "
             "path: and by what surfaces scatter; bounds: blue to red, for how long rays meet moving meshes' boxes as "
             "the kernels see it, bounds-exact: "
             "as it is");
  add_count(app, "--max-depth", params.max_depth, 0, 64,
            "whitted, path: how often a ray may be reflected or refracted, or light scattered");
  add_real(app, "--clamp", "path: the most that light scattered more than once brings to a sample; 0: no limit [0]",
           "L", [&params](double v) {
             if (!(v >= 0 && v <= 1e30)) throw CLI::ValidationError("--clamp", "must be 0 to 1e30");
             params.clamp = static_cast<float>(v);
           });
  app.add_option("--calibration", out.calibration,
                 "What rays cost, by which auto chooses them: a file of kairos calibrate, or default: estimated")
      ->type_name("FILE|default");
  add_count(app, "--seed", params.seed, 0, UINT64_MAX, "Another seed gives another noise");
  add_choice(app, "--filter", params.filter, "Pixel filter");
  add_instruction_set(app, params.instruction_set);
}

void choose_integrator(const CLI::App& app, RenderParams& params) {
  if (app.count("--tc-rays") > 0 && app.count("--integrator") == 0) params.integrator = IntegratorKind::tc;
}

void read_calibration_into(SamplingArguments& arguments) {
  if (arguments.calibration == kDefaultCalibration) return;
  if (arguments.params.integrator != IntegratorKind::automatic)
    throw Error(ErrorCode::bad_usage, "--calibration", "only the integrator auto chooses rays by what they cost");
  const CalibrationFile file = read_calibration(arguments.calibration);
  const std::string_view shading = to_string(arguments.params.shading);
  if (file.shading != arguments.params.shading)
    throw Error(ErrorCode::bad_input, arguments.calibration,
                fmt::format("was measured with '--shading {}', and this picture has '{}'; measure again with kairos "
                            "calibrate --shading {}",
                            to_string(file.shading), shading, shading));
  arguments.params.calibration = file.calibration;
}

}  // namespace kairos::cli
