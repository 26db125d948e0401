// kairos render: scene in, picture out.
#include <algorithm>
#include <memory>

#include "arguments.h"
#include "commands.h"
#include "frames.h"
#include "rendering.h"
#include "time_arguments.h"

namespace kairos::cli {

namespace {

void add_picture_options(CLI::App& app, RenderArguments& out) {
  RenderParams& params = out.sampling.params;
  app.add_option("-o,--output", out.files.out, "The picture to write")->type_name("OUT.exr|OUT.png");
  app.add_flag("--half", out.write.half, "16-bit colours in EXR (depth stays 32-bit)");
  add_view_options(app, out.view);
  app.add_option_function<std::string>(
         "--aov",
         [&params](const std::string& text) {
           params.aovs.clear();
           for (std::string_view rest = text;;) {
             const size_t comma = rest.find(',');
             const Aov aov = parse_choice<Aov>("--aov", rest.substr(0, comma));
             if (std::find(params.aovs.begin(), params.aovs.end(), aov) != params.aovs.end())
               throw CLI::ValidationError("--aov", fmt::format("'{}' is named twice", rest.substr(0, comma)));
             params.aovs.push_back(aov);
             if (comma == std::string_view::npos) break;
             rest.remove_prefix(comma + 1);
           }
         },
         "Further EXR layers, separated by commas: depth, normal, albedo, coverage, segments, mesh")
      ->type_name("A,B,...");
  app.add_option_function<std::string>(
         "--crop",
         [&params](const std::string& text) {
           constexpr uint64_t kMost = 65536;
           const auto parts = split("--crop", text, ',', 4, "X0,X1,Y0,Y1");
           const auto side = [&](size_t i) { return static_cast<int>(parse_count("--crop", parts[i], 0, kMost)); };
           params.crop = Crop{side(0), side(1), side(2), side(3)};
           if (params.crop->x0 >= params.crop->x1 || params.crop->y0 >= params.crop->y1)
             throw CLI::ValidationError("--crop", fmt::format("'{}' is empty; give X0 < X1 and Y0 < Y1", text));
         },
         "Pixels to render: X0 to X1 (without it), Y0 to Y1, from the upper left corner")
      ->type_name("X0,X1,Y0,Y1");
}

}  // namespace

void add_render_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("render", "Render a scene to a picture");
  const auto arguments = std::make_shared<RenderArguments>();
  arguments->command_line = command_line;
  arguments->command = &command;
  add_scene_arguments(command, arguments->scene);
  add_picture_options(command, *arguments);
  add_time_options(command, arguments->files.time, arguments->time_options);
  add_exposure_options(command, arguments->sampling.exposure);
  add_light_options(command, arguments->light);
  add_sampling_options(command, arguments->sampling);
  command.add_option("--stats-file", arguments->files.stats_file, "Write times, memory and counters to this JSON file")
      ->type_name("F.json");
  command
      .add_option_function<std::string>(
          "--frames",
          [arguments](const std::string& text) { arguments->files.frames = parse_frames("--frames", text); },
          "Render these frames, each as with --frame; names of files then have %04d. Those that are there are skipped. "
          "With "
          "--time: one file of all of their time")
      ->type_name("A-B")
      ->excludes("--frame");
  command
      .add_option_function<std::string>(
          "--part",
          [arguments](const std::string& text) {
            arguments->parts_from_input = text == "-";
            if (!arguments->parts_from_input) arguments->files.part = parse_part("--part", text);
          },
          "Render part I of N of the job, to be merged (kairos merge); of a Slurm array, the task's part; or the parts "
          "named "
          "on standard input, one a line, each of which is said on standard output when it is done")
      ->type_name("I/N|slurm|-")
      ->excludes("--stats-file");
  add_real(
      command, "--checkpoint",
      "Write what is done every so many seconds, beside the picture; the same command goes on where it was stopped",
      "SECONDS", [arguments](double seconds) {
        if (seconds < 0) throw CLI::ValidationError("--checkpoint", "give 0 or more seconds");
        arguments->checkpoint = seconds;
      });
  for (const char* other : {"--part", "--time", "--stats-file"}) command.get_option("--checkpoint")->excludes(other);
  add_progress_option(command, arguments->progress);
  command.add_flag("--quiet", arguments->quiet, "No log and no progress, errors only");
  command.callback([arguments, &chosen, &command] {
    choose_integrator(command, arguments->sampling.params);
    if (arguments->files.out.empty() && arguments->files.time.empty()) throw CLI::RequiredError("--output");
    if (arguments->files.frames && !arguments->files.time.empty()) {
      for (const char* other : {"--output", "--stats-file", "--shutter", "--rolling", "--curve", "--interval-map"})
        if (command.get_option(other)->count() > 0)
          throw CLI::ValidationError(
              other, "does not go with --time of several --frames, which holds all of their time: kairos expose");
    } else if (arguments->files.frames) {
      FrameName::check("--output", arguments->files.out);
      if (!arguments->files.stats_file.empty()) FrameName::check("--stats-file", arguments->files.stats_file);
    }
    arguments->sampling.params.threads = arguments->scene.threads;
    const std::vector<Aov>& aovs = arguments->sampling.params.aovs;
    arguments->scene.shot.textures = arguments->sampling.params.shading != ShadingKind::normal ||
                                     std::find(aovs.begin(), aovs.end(), Aov::albedo) != aovs.end();
    arguments->scene.shot.strict = arguments->scene.load.strict;
    arguments->light.apply(command, arguments->sampling.params, arguments->scene.shot);
    check_view(command, arguments->files.out);
    chosen = [arguments] { tell_failure(arguments->progress, [&] { run_render(*arguments); }); };
  });
}

}  // namespace kairos::cli
