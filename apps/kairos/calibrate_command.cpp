// kairos calibrate: scene in, prices of rays out.
#include <memory>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/render.h>

#include "arguments.h"
#include "commands.h"
#include "interrupt.h"
#include "log.h"
#include "sampling_arguments.h"

namespace kairos::cli {

namespace {

struct CalibrateArguments {
  SceneArguments scene;
  RenderParams params = lit();
  std::string out;
  bool quiet = false;
};

Calibration measure(const Shot& shot, const RenderParams& params) {
  Renderer renderer(shot);
  begin_polling();
  try {
    const Calibration calibration = renderer.calibrate(params, [](double) { return !interrupted(); });
    end_polling();
    if (!interrupted()) return calibration;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
  }
  throw Error(ErrorCode::cancelled, "", "interrupted");
}

void run_calibrate(const CalibrateArguments& arguments) {
  check_writable(arguments.out);
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  if (!arguments.quiet)
    for (const std::string& warning : contents(*scene).warnings) log("warning: " + warning);
  const Shot shot = make_shot(*scene, shot_options(arguments.scene, *scene));
  const CalibrationFile result{measure(shot, arguments.params), arguments.params.shading};
  write_calibration(result, arguments.out);
  if (arguments.quiet) return;
  const Calibration& c = result.calibration;
  std::string prices = fmt::format("a discrete sample takes {:.0f} ns, a still ray {:.0f} ns, a time-continuous ray",
                                   c.discrete_sample, c.still_ray);
  for (size_t i = 0; i < c.tc_ray.size(); ++i)
    prices += fmt::format("{} {:.0f} ns (of {})", i == 0 ? "" : ",", c.tc_ray[i], Calibration::kRays[i]);
  log(prices);
  log("wrote " + arguments.out);
}

}  // namespace

void add_calibrate_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("calibrate", "Measure what rays of a shot cost, for auto to choose by");
  const auto arguments = std::make_shared<CalibrateArguments>();
  RenderParams& params = arguments->params;
  add_scene_arguments(command, arguments->scene);
  command.add_option("-o,--output", arguments->out, "The file to write")->type_name("FILE.json")->required();
  add_choice(command, "--shading", params.shading, "As for render: rays are shaded, too", kSurfaceShadings);
  add_count(command, "--max-depth", params.max_depth, 0, 64, "As for render");
  add_count(command, "--shading-samples", params.shading_samples, 1, 1u << 16, "As for render");
  add_choice(command, "--clusters", params.clusters, "As for render");
  add_instruction_set(command, params.instruction_set);
  command.add_flag("--quiet", arguments->quiet, "Errors only");
  command.callback([arguments, &chosen] {
    arguments->scene.shot.textures = arguments->params.shading != ShadingKind::normal;
    arguments->scene.shot.strict = arguments->scene.load.strict;
    if (is_lit(arguments->params.shading)) arguments->scene.shot.lights = LightChoice::automatic;
    arguments->params.threads = arguments->scene.threads;
    chosen = [arguments] { run_calibrate(*arguments); };
  });
}

}  // namespace kairos::cli
