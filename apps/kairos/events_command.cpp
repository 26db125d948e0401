// kairos events: scene in, the stream of an event camera out.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include <kairos/animations.h>
#include <kairos/error.h>
#include <kairos/event_parts.h>
#include <kairos/files.h>
#include <kairos/scene_files.h>

#include "commands.h"
#include "events_arguments.h"
#include "events_checkpoint.h"
#include "events_commands.h"
#include "frame_mark.h"
#include "interrupt.h"
#include "log.h"
#include "parts.h"
#include "progress_bar.h"
#include "report.h"

namespace kairos::cli {

namespace {

/// Hands events to all files, and to the folder where there is one.
class Files : public EventSink {
 public:
  Files(const std::vector<std::string>& paths, int width, int height, const EventFileOptions& options,
        EventFolder* folder)
      : folder_(folder) {
    for (const std::string& path : paths) {
      // Each file takes of the options what it knows.
      EventFileOptions own = options;
      if (paths.size() > 1 && !path.ends_with(".txt")) own.header = EventFileOptions::Header::none;
      own.labels = options.labels && holds_labels(path);
      files_.push_back(std::make_unique<EventFileWriter>(path, width, height, own));
    }
  }
  void add(std::span<const Event> events) override {
    for (const auto& file : files_) file->add(events);
    if (folder_ != nullptr) folder_->add(events);
  }
  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override {
    for (const auto& file : files_) file->add_labelled(events, labels);
    if (folder_ != nullptr) folder_->add_labelled(events, labels);
  }
  void finish() {
    for (const auto& file : files_) file->finish();
  }

 private:
  std::vector<std::unique_ptr<EventFileWriter>> files_;
  EventFolder* folder_;
};

/// As long as the animation that plays, or else the second from 0 on.
void choose_times(const EventsArguments& arguments, const Scene& scene, EventOptions& options) {
  for (const SceneAnimation& animation : animations(scene))
    if (animation.plays && animation.range && (*animation.range)[0] < (*animation.range)[1]) {
      options.from = (*animation.range)[0];
      options.to = (*animation.range)[1];
      break;
    }
  if (arguments.from) options.from = *arguments.from;
  if (arguments.to)
    options.to = *arguments.to;
  else if (options.to <= options.from)
    options.to = options.from + 1;
}

/// What stamps may be off by: of a fast edge and of a slow one.
std::string error_text(const EventOptions& options, const EventStats& stats) {
  const EventErrors errors = event_errors(options);
  const auto at = [&](double speed) {
    return fmt::format("{:.3g} us at {:.4g} px/s", (errors.motion + errors.area) / speed * 1e6, speed);
  };
  constexpr double kUsual = 1000;
  return fmt::format(
      "stamps are off by at most about {:.3g} px of motion between keys (--motion-tolerance) and {:.3g} px {}: {}{}",
      errors.motion, errors.area,
      options.edges == EdgeModel::area ? "at outlines of a radius of 5 px" : "by steps of single rays", at(kUsual),
      stats.fastest > 0 ? ", " + at(stats.fastest) + ", the fastest edge" : "");
}

/// What decides the events of a part.
std::string mark_of_part(const EventsArguments& arguments, const CLI::App& command, const Scene& scene) {
  std::vector<std::string> files = kairos::files(scene);
  if (arguments.light.environment) files.push_back(arguments.light.environment->path);
  for (const std::string& sensor : command.get_option("--sensor")->results())
    if (sensor.ends_with(".json")) files.push_back(sensor);
  return frame_mark(
      command, {"SCENE", "--output", "--environment", "--threads", "--quiet", "--part", "--progress", "--checkpoint"},
      files);
}

/// Records rows of pixels into a file of the folder of parts.
void choose_part(const EventsArguments& arguments, EventOptions& options, std::vector<std::string>& paths) {
  if (arguments.outs.size() > 1)
    throw Error(ErrorCode::bad_usage, "", "--part: a recording in parts goes to one file; give one --output");
  options.crop = band_of({0, options.shot.width, 0, options.shot.height}, *arguments.part);
  paths = {part_file(arguments.outs.front(), *arguments.part, ".npz")};
  make_parts_folder(paths.front());
}

/// Does the work while a bar shows how far it is.
void with_bar(const EventsArguments& arguments, const std::function<void(const Progress&)>& work) {
  std::unique_ptr<ProgressBar> bar;
  bool polling = false;
  try {
    work([&](double fraction) {
      if (!polling) begin_polling();
      polling = true;
      if (!bar && (!arguments.quiet || arguments.progress == ProgressStyle::openjd))
        bar = std::make_unique<ProgressBar>(0, arguments.progress);
      if (bar) bar->update(fraction);
      return !interrupted();
    });
    end_polling();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
    throw Error(ErrorCode::cancelled, "", "interrupted");
  }
}

void run_events(const EventsArguments& arguments, const CLI::App& command, const std::string& command_line) {
  EventOptions options = arguments.options;
  options.shot = arguments.scene.shot;
  std::vector<std::string> paths = arguments.outs;
  if (arguments.has_layout) paths.erase(paths.begin());  // the folder
  EventFileOptions file = arguments.file;
  file.labels = options.labels && (!arguments.part || holds_labels(paths.front()));
  for (const std::string& path : paths)
    check_event_file(path, options.shot.width, options.shot.height, arguments.part ? file : EventFileOptions{});
  if (arguments.part) choose_part(arguments, options, paths);
  for (const std::string& path : paths) check_writable(path);
  const bool folder_has_labels = arguments.has_layout && keeps_labels(arguments.folder.layout);
  if (options.labels && !folder_has_labels && std::none_of(paths.begin(), paths.end(), holds_labels))
    throw Error(ErrorCode::bad_usage, arguments.outs.front(),
                "holds no labels; let --labels write an .npz, .npy, .h5 or .hdf5, too");
  const auto say = [&](const std::string& line) {
    if (!arguments.quiet) log(line);
  };
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  for (const std::string& warning : contents(*scene).warnings) say("warning: " + warning);
  std::string mark;
  if (arguments.part) {
    mark = mark_of_part(arguments, command, *scene);
    if (const auto there = event_part_mark(paths.front()); there == mark)
      return say(paths.front() + " is there already");
    else if (there)
      refuse_other_part(paths.front());
  }
  options.render.threads = arguments.scene.threads;
  options.change_shot = [&](Shot& shot) { arguments.light.background.apply(shot); };
  choose_times(arguments, *scene, options);
  file.duration = std::llround((options.to - options.from) * 1e9);
  file.kinds = has_kinds(options);
  std::optional<EventFolder> folder;
  if (arguments.has_layout) {
    EventFolderOptions of = arguments.folder;
    of.epoch = file.epoch;
    folder.emplace(arguments.outs.front(), of, *scene, options);
  }
  Files files(paths, options.shot.width, options.shot.height, arguments.part ? event_part_options(file) : file,
              folder ? &*folder : nullptr);
  const Stopwatch recording;
  EventStats stats;
  std::optional<EventCheckpoints> checkpoints;
  if (arguments.checkpoint) {
    checkpoints.emplace(arguments.outs.front(), mark_of_part(arguments, command, *scene), *arguments.checkpoint,
                        options.labels, files);
    options.resume = checkpoints->resume(options.shot.width, options.shot.height);
    if (!options.resume.empty()) say("going on with " + arguments.outs.front() + ".unfinished");
  }
  EventSink& sink = checkpoints ? static_cast<EventSink&>(*checkpoints) : files;
  with_bar(arguments, [&](const Progress& progress) { stats = record_events(*scene, options, sink, progress); });
  files.finish();
  for (const std::string& note : stats.notes) say("note: " + note);
  const double seconds = options.to - options.from;
  say(fmt::format("{} events in {:.6g} s of {}x{} pixels: {} on, {} off{}, {:.3g} per pixel and second",
                  stats.on + stats.off, seconds, stats.width, stats.height, stats.on, stats.off,
                  stats.leak + stats.shot > 0
                      ? fmt::format(", of them {} of leaking and {} of shot noise", stats.leak, stats.shot)
                      : "",
                  static_cast<double>(stats.on + stats.off) / seconds / stats.width / stats.height));
  say(fmt::format("{} moving edges, {} changes without an edge that is known; {:.1f} s, {:.1f} s of processor time",
                  stats.edges, stats.steps, recording.seconds(), stats.cpu_seconds));
  say(error_text(options, stats));
  if (folder) {
    const Stopwatch rendering;
    with_bar(arguments, [&](const Progress& progress) { folder->finish(progress); });
    const std::string& path = arguments.outs.front();
    write_event_notes(path + "/recording.json", options, stats, command_line);
    say(fmt::format("wrote {}: pictures, depth, flow and poses in {:.1f} s", path, rendering.seconds()));
  }
  if (checkpoints) checkpoints->remove();
  for (const std::string& path : paths) {
    if (arguments.part)
      write_event_part_notes(path, options, stats, command_line, file, mark);
    else
      write_event_notes(path + ".json", options, stats, command_line);
    say(fmt::format("wrote {} and {}.json", path, path));
  }
}

void add_record_options(CLI::App& command, EventsArguments& arguments) {
  EventOptions& options = arguments.options;
  command
      .add_option("-o,--output", arguments.outs,
                  fmt::format("The file to write, one of {}; may be given several times", event_file_endings()))
      ->type_name("OUT");
  add_event_folder_options(command, arguments);
  add_real(command, "--from",
           "Scene time at which the recording begins, in seconds (default: the animation's begin, or 0)", "S",
           [&arguments](double value) { arguments.from = value; });
  add_real(command, "--to", "Scene time at which it ends (default: the animation's end, or a second after it begins)",
           "S", [&arguments](double value) { arguments.to = value; });
  add_count(command, "--rays", options.rays, 1, 256, "Rays per pixel: 1, 4, 16, 64 or 256");
  add_choice(command, "--edges", options.edges,
             "How an edge passes a pixel. area: it covers each ray's part as it moves over it; step: rays jump");
  command.add_flag(
      "--labels", options.labels,
      "Also say of each event, in .npz, .npy, .h5 and .hdf5, which surface made it and what lies behind, depth, "
      "flow and kind");
  add_event_sensor_options(command, options.sensor);
  add_event_file_options(command, arguments.file);
  add_choice(command, "--shading", options.render.shading,
             "normal: |normal| as colour; flat: base colour, unlit; whitted: lit, with shadows, mirrors and glass; "
             "path: and by what surfaces scatter",
             kSurfaceShadings);
  add_count(command, "--max-depth", options.render.max_depth, 0, 64,
            "whitted, path: how often a ray may be reflected or refracted, or light scattered");
  add_count(command, "--looks", options.looks, 2, 65536, "How often in a second colours are looked at, at least");
  add_real(command, "--chunk", "Seconds that are rendered at once [0.5]", "S",
           [&options](double value) { options.chunk = value; });
  add_count(command, "--seed", options.render.seed, 0, UINT64_MAX, "Another seed: other points in pixels, other noise");
  add_instruction_set(command, options.render.instruction_set);
  command
      .add_option_function<std::string>(
          "--part", [&arguments](const std::string& text) { arguments.part = parse_part("--part", text); },
          "Record part I of N, some rows of pixels, to be merged (kairos merge); of a Slurm array, the task's part")
      ->type_name("I/N|slurm");
  command
      .add_option_function<std::string>(
          "--checkpoint",
          [&arguments](const std::string& text) {
            const double seconds = parse_real("--checkpoint", text);
            if (seconds < 0) throw CLI::ValidationError("--checkpoint", "give 0 or more seconds");
            arguments.checkpoint = seconds;
          },
          "Keep what is done, at least every so many seconds: when it is killed, the same command goes on")
      ->type_name("SECONDS")
      ->excludes("--part");
  add_progress_option(command, arguments.progress);
  command.add_flag("--quiet", arguments.quiet, "No log and no progress, errors only");
}

}  // namespace

void add_events_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("events", "Record a scene as an event camera sees it");
  const auto arguments = std::make_shared<EventsArguments>();
  constexpr int kWidth = 346, kHeight = 260;  // of a DAVIS346
  constexpr double kTolerance = 0.005;
  arguments->scene.shot.width = kWidth;
  arguments->scene.shot.height = kHeight;
  arguments->scene.shot.motion_tolerance = kTolerance;
  arguments->options.render.shading = ShadingKind::whitted;
  add_scene_only_arguments(command, arguments->scene);
  add_record_options(command, *arguments);
  add_light_options(command, arguments->light);
  add_events_info_command(command, chosen);
  add_events_compare_command(command, chosen);
  add_events_play_command(command, chosen);
  command.callback([arguments, &chosen, &command, command_line] {
    if (!command.get_subcommands().empty()) return;
    if (arguments->scene.paths.empty()) throw CLI::RequiredError("SCENE");
    if (arguments->outs.empty()) throw CLI::RequiredError("--output");
    if (arguments->has_layout && arguments->part)
      throw CLI::ValidationError("--part",
                                 "a folder of --layout is made in one piece: its pictures are of the whole frame, and "
                                 "their times may depend on all events; let parts go to a file");
    arguments->scene.shot.textures = arguments->options.render.shading != ShadingKind::normal;
    arguments->scene.shot.strict = arguments->scene.load.strict;
    arguments->light.apply(command, arguments->options.render, arguments->scene.shot);
    chosen = [arguments, &command, command_line] {
      tell_failure(arguments->progress, [&] { run_events(*arguments, command, command_line); });
    };
  });
}

}  // namespace kairos::cli
