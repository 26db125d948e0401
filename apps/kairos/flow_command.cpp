// kairos flow: where what each pixel shows at one instant is at another.
#include <algorithm>
#include <memory>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/flow.h>
#include <kairos/time_file.h>

#include "arguments.h"
#include "commands.h"
#include "frames.h"
#include "interrupt.h"
#include "log.h"
#include "progress_bar.h"
#include "time_arguments.h"

namespace kairos::cli {

namespace {

struct FlowArguments {
  SceneArguments scene;
  Duration from{0, false}, to{1, false};
  std::optional<FrameRange> frames;
  std::string out, occlusion, command_line;  ///< names of files; occlusion: or empty
  std::optional<InstructionSet> instruction_set;
  bool quiet = false;
};

void add_time(CLI::App& app, const std::string& name, Duration& out, const std::string& help) {
  app.add_option_function<std::string>(
         name, [&out, name](const std::string& text) { out = parse_duration(name, text); }, help)
      ->type_name("TIME");
}

/// make_flow(options): the flow between the two instants.
template <class MakeFlow>
void write_flow_of(const FlowArguments& arguments, const MakeFlow& make_flow, WorkProgress& work,
                   const std::string& out, const std::string& occlusion) {
  FlowOptions options;
  options.threads = arguments.scene.threads;
  options.instruction_set = arguments.instruction_set;
  options.progress = work.of_piece();
  begin_polling();
  Image image = make_flow(options);
  end_polling();
  work.next();
  image.attributes.push_back({"kairos:command_line", arguments.command_line});
  write_flow(image, out);
  if (!occlusion.empty()) write_occlusion(image, occlusion);
  if (arguments.quiet) return;
  size_t counts[4] = {};
  for (const float state : image.find("flow.state")->values) ++counts[static_cast<size_t>(state)];
  const double percent = 100.0 / static_cast<double>(image.find("flow.state")->values.size());
  cli::log(
      fmt::format("wrote {}: of the points {:.1f} % are seen at both instants, {:.1f} % are hidden, {:.1f} % leave the "
                  "frame, {:.1f} % are unknown",
                  out, percent * static_cast<double>(counts[1]), percent * static_cast<double>(counts[2]),
                  percent * static_cast<double>(counts[3]), percent * static_cast<double>(counts[0])));
}

/// Of what a file of time holds: all of its frame, whatever the crop.
void flow_of_file(const FlowArguments& arguments) {
  const std::string& path = arguments.scene.paths.front();
  check_writable_flow(arguments.out);
  if (!arguments.occlusion.empty()) check_writable(arguments.occlusion);
  const TimeFile file = TimeFile::open(path);
  const TimeFrame& frame = file.picture().frame();
  if (!file.has_geometry())
    throw Error(ErrorCode::bad_input, path,
                "does not hold where things are; render it again with --time-planes geometry");
  const double fps = arguments.scene.shot.fps.value_or(frame.fps);
  WorkProgress work(arguments.quiet, 1);
  const double from = arguments.from.in_seconds(fps), to = arguments.to.in_seconds(fps);
  check_recorded(path, frame, frame.frame_time + std::min(from, to), frame.frame_time + std::max(from, to));
  write_flow_of(
      arguments, [&](const FlowOptions& options) { return file.flow(from, to, options); }, work, arguments.out,
      arguments.occlusion);
}

/// Of the frame that `scene.shot` says.
void write_frame(const FlowArguments& arguments, const Scene& scene, const ShotOptions& of_frame, WorkProgress& work,
                 const std::string& out, const std::string& occlusion) {
  ShotOptions options = of_frame;
  const double fps = options.fps.value_or(contents(scene).fps);
  const double from = arguments.from.in_frames(fps), to = arguments.to.in_frames(fps);
  options.shutter = {std::min(from, to), std::max(from, to)};
  options.textures = false;
  const Shot shot = make_shot(scene, options);
  write_flow_of(
      arguments,
      [&](FlowOptions flow_options) {
        flow_options.backward = to < from;
        return flow(shot, flow_options);
      },
      work, out, occlusion);
}

void run_flow(const FlowArguments& arguments) {
  if (holds_time(arguments.scene.paths)) return flow_of_file(arguments);
  const FrameRange frames = arguments.frames.value_or(FrameRange{});
  const auto name = [&](const char* option, const std::string& text, int frame) {
    return !arguments.frames || text.empty() ? text : FrameName(option, text).at(frame);
  };
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    check_writable_flow(name("--output", arguments.out, frame));
    if (!arguments.occlusion.empty()) check_writable(name("--occlusion", arguments.occlusion, frame));
  }
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  if (!arguments.quiet)
    for (const std::string& warning : contents(*scene).warnings) cli::log("warning: " + warning);
  WorkProgress work(arguments.quiet, static_cast<size_t>(frames.count()));
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    ShotOptions options = arguments.scene.shot;
    if (arguments.frames) options.frame = frame;
    write_frame(arguments, *scene, options, work, name("--output", arguments.out, frame),
                name("--occlusion", arguments.occlusion, frame));
  }
}

}  // namespace

void add_flow_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("flow", "Where what each pixel shows at one instant is at another");
  const auto arguments = std::make_shared<FlowArguments>();
  arguments->command_line = command_line;
  add_scene_arguments(command, arguments->scene);
  add_time(command, "--from", arguments->from, "The one instant, from the frame's time, with --shutter's units [0]");
  add_time(command, "--to", arguments->to, "The other one; may be the earlier one [1f]");
  command.add_option("-o,--output", arguments->out, "The flow: Middlebury's .flo, KITTI's .png, or EXR")
      ->type_name("OUT.flo|OUT.png|OUT.exr")
      ->required();
  command.add_option("--occlusion", arguments->occlusion, "A picture that is white where a point is not seen at --to")
      ->type_name("OUT.png");
  command
      .add_option_function<std::string>(
          "--frames", [arguments](const std::string& text) { arguments->frames = parse_frames("--frames", text); },
          "Flow of these frames, each as with --frame; names of files then have %04d")
      ->type_name("A-B")
      ->excludes("--frame");
  add_instruction_set(command, arguments->instruction_set);
  command.add_flag("--quiet", arguments->quiet, "Errors only");
  command.callback([arguments, &chosen, &command] {
    if (holds_time(arguments->scene.paths))
      check_options_of_file(command, {"--from", "--to", "--occlusion", "--instruction-set"});
    if (arguments->scene.shutter)
      throw CLI::ValidationError("--shutter", "flow goes from one instant to another; give --from and --to");
    if (arguments->from.value == arguments->to.value && arguments->from.seconds == arguments->to.seconds)
      throw CLI::ValidationError("--to", "is the instant of --from");
    if (arguments->frames) FrameName::check("--output", arguments->out);
    if (arguments->frames && !arguments->occlusion.empty()) FrameName::check("--occlusion", arguments->occlusion);
    arguments->scene.shot.strict = arguments->scene.load.strict;
    chosen = [arguments] { run_flow(*arguments); };
  });
}

}  // namespace kairos::cli
