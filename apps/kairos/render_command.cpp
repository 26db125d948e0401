// kairos render: scene in, picture out.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/picture.h>
#include <kairos/render.h>
#include <kairos/scene_files.h>
#include <kairos/time_file.h>

#include "arguments.h"
#include "checkpoint.h"
#include "commands.h"
#include "frame_mark.h"
#include "frames.h"
#include "interrupt.h"
#include "light_arguments.h"
#include "log.h"
#include "parts.h"
#include "progress_bar.h"
#include "render_jobs.h"
#include "render_stats.h"
#include "report.h"
#include "sampling_arguments.h"
#include "time_arguments.h"
#include "view_arguments.h"

namespace kairos::cli {

namespace {

struct RenderArguments {
  SceneArguments scene;
  SamplingArguments sampling;
  WriteOptions write;
  TimeFileOptions time_options;  ///< tolerance and planes
  RenderFiles files;
  std::string command_line;
  std::optional<double> checkpoint;  ///< seconds
  ViewArguments view;
  LightArguments light;
  const CLI::App* command = nullptr;
  ProgressStyle progress = ProgressStyle::automatic;
  bool quiet = false;
};

void say(const RenderArguments& arguments, const std::string& line) {
  if (!arguments.quiet) log(line);
}

uint64_t total_rays(const RenderParams& params, const Shot& shot) {
  const Crop crop = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
  const int per_pixel = params.integrator == IntegratorKind::tc ? params.tc_rays : params.spp;
  return static_cast<uint64_t>(crop.x1 - crop.x0) * static_cast<uint64_t>(crop.y1 - crop.y0) *
         static_cast<uint64_t>(per_pixel);
}

/// Which of how many jobs.
struct Place {
  size_t number = 0, count = 1;
};

/// work: what renders, and tells how far it is.
void with_progress(const RenderArguments& arguments, Place place, uint64_t rays,
                   const std::function<void(const Progress&)>& work) {
  std::unique_ptr<ProgressBar> bar;
  bool polling = false;
  const auto progress = [&](double fraction) {
    if (!polling) begin_polling();  // rendering has begun: before, a signal ends the program at once
    polling = true;
    if (!bar && (!arguments.quiet || arguments.progress == ProgressStyle::openjd))
      bar = std::make_unique<ProgressBar>(static_cast<double>(rays), arguments.progress, place.number, place.count);
    if (bar) bar->update(fraction);
    return !interrupted();
  };
  try {
    work(progress);
    end_polling();
    if (!interrupted()) return;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
  }
  throw Error(ErrorCode::cancelled, "", "interrupted");
}

/// What decides the pixels of a job that several runs render.
std::string mark_of(const RenderArguments& arguments, const Scene& scene) {
  const RenderFiles& out = arguments.files;
  const bool several = out.frames || out.part || arguments.checkpoint || !out.time.empty();
  if (!several) return "";
  std::vector<std::string> files = kairos::files(scene);
  if (arguments.sampling.calibration != kDefaultCalibration) files.push_back(arguments.sampling.calibration);
  if (!arguments.sampling.exposure.map.empty()) files.push_back(arguments.sampling.exposure.map);
  if (arguments.light.environment) files.push_back(arguments.light.environment->path);
  return frame_mark(*arguments.command,
                    {"SCENE", "--output", "--frames", "--stats-file", "--calibration", "--environment",
                     "--interval-map", "--threads", "--quiet", "--time", "--part", "--checkpoint", "--progress"},
                    files);
}

/// Before the scene is loaded, which may take long: can all that is to be written be written?
void check_writable_files(const RenderArguments& arguments, const std::vector<FrameJob>& jobs) {
  const bool again = arguments.files.frames || arguments.files.part;  // what is there may stay as it is
  for (const FrameJob& job : jobs) {
    for (const std::string& path : {job.out, job.time})
      if (job.part && !path.empty()) make_parts_folder(path);
    if (!job.out.empty() && !(again && std::filesystem::is_regular_file(job.out))) check_writable_image(job.out);
    if (!job.stats_file.empty()) check_writable(job.stats_file);
  }
}

/// Leaves those that are not done yet. Pictures get their name when they are complete: what is there need not be made
/// again, unless a disk lost some of it.
void leave_what_is_there(const RenderArguments& arguments, const std::string& mark, std::vector<FrameJob>& jobs) {
  if (!arguments.files.frames && !arguments.files.part) return;
  const size_t count = jobs.size();
  std::erase_if(jobs, [&](const FrameJob& job) {
    const bool found = is_there(job, mark);
    for (const std::string& path : {job.out, job.time})
      if (!found && job.stats_file.empty() && !path.empty() && std::filesystem::is_regular_file(path))
        say(arguments, path + " is no whole picture: it is made again");
    return found;
  });
  if (jobs.size() < count)
    say(arguments, fmt::format("{} of {} {} are there already", count - jobs.size(), count,
                               arguments.files.part ? "parts" : "frames"));
}

void render_job(const RenderArguments& arguments, const FrameJob& job, Place place, const std::string& mark,
                const Scene& scene, Timings timings, std::set<std::string>& told) {
  const Stopwatch reducing;
  SceneArguments of_job = arguments.scene;
  of_job.shot = job.shot;
  const ExposedShot exposed = exposed_shot(of_job, arguments.sampling.exposure, scene);
  Shot shot = make_shot(scene, exposed.options);
  arguments.light.background.apply(shot);
  RenderParams params = arguments.sampling.params;
  params.exposure = exposed.exposure(shot);
  const Crop whole = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
  if (job.part) params.crop = pixels_of(job, whole);
  timings.shot = reducing.seconds();
  say(arguments, fmt::format("loaded {} meshes, {} triangles in {:.2f} s; {}x{} pixels, shutter {} to {}",
                             shot.meshes.size(), triangle_count(shot.meshes), timings.load + timings.shot,
                             shot.projection.width, shot.projection.height, shot.shutter_open, shot.shutter_close));
  if (exposed.shutter) say(arguments, shutter_text(*exposed.shutter, shot.projection.width, shot.projection.height));
  for (const std::string& note : shot.notes)
    if (told.insert(note).second) say(arguments, "note: " + note);

  WriteOptions write = arguments.write;
  write.view = arguments.view.choice.value_or(usual_view(shot, arguments.sampling.params.shading));
  write.exposure = arguments.view.exposure;
  const int frame = arguments.files.frames ? static_cast<int>(*job.shot.frame) : -1;
  if (arguments.checkpoint) {
    MergedPicture merged;
    with_progress(arguments, place, total_rays(params, shot), [&](const Progress& progress) {
      merged = render_with_checkpoints(
          {shot, params, job.out, mark, arguments.command_line, frame, write, *arguments.checkpoint}, progress);
    });
    write_interruptibly(merged.image, job.out, write);
    remove_parts(merged.parts, job.out);
    return;
  }

  RenderStats stats;
  std::optional<Picture> picture;
  std::optional<TimeFileWriter> time;
  std::vector<PixelConsumer*> consumers;
  RenderParams of_rays = params;
  if (!job.out.empty()) consumers.push_back(&picture.emplace(shot.projection, params));
  if (!job.time.empty()) {
    of_rays.exposure.reset();  // rays look at all of the time that the file holds
    const FrameClock clock = clock_of(exposed.options, contents(scene));
    RenderParams of_file = of_rays;  // a part holds some tiles of the whole
    of_file.crop = whole;
    TimeFileOptions options = arguments.time_options;
    options.clock = clock;
    options.mark = mark;
    time.emplace(job.time, shot, of_file, options);
    consumers.push_back(&*time);
    const auto is_cut_out = [](const Material& m) { return m.alpha_mode == Material::AlphaMode::mask; };
    if (options.geometry && std::any_of(shot.materials.begin(), shot.materials.end(), is_cut_out))
      say(arguments, "note: the geometry of '" + job.time +
                         "' has no cut-outs: flow takes surfaces as whole; kairos flow SCENE does not");
    if (time->tiles_before() > 0)
      say(arguments,
          fmt::format("{} of {} tiles are in '{}.part' already", time->tiles_before(), time->tiles(), job.time));
  }
  with_progress(arguments, place, total_rays(params, shot),
                [&](const Progress& progress) { Renderer(shot).render(of_rays, consumers, &stats, progress); });
  say(arguments,
      fmt::format("built in {:.2f} s, rendered {} rays in {:.2f} s ({}rays/s) on {} threads, {}", stats.build_seconds,
                  stats.rays, stats.render_seconds, with_unit(static_cast<double>(stats.rays) / stats.render_seconds),
                  stats.threads,
                  stats.instruction_set ? fmt::format("instruction set {}", to_string(*stats.instruction_set))
                                        : std::string("Embree")));

  const Stopwatch writing;
  if (time && job.part) {
    time->finish_part();
    say(arguments, "wrote " + job.time);
  } else if (time) {
    time->finish();
    say(arguments, time_file_text(job.time));
  }
  if (picture) {
    Image image = picture->take();
    describe(image, shot, params, stats);
    image.attributes.push_back({"kairos:command_line", arguments.command_line});
    if (job.part)
      describe_part(image, *job.part, frame, mark, write);
    else if (arguments.files.frames)
      image.attributes.push_back({kFrameMarkName, mark});
    write_interruptibly(image, job.out, job.part ? part_options(arguments.files.out, write) : write);
  }
  timings.write = writing.seconds();
  if (!job.stats_file.empty()) {
    write_file(job.stats_file, stats_text(params, shot, stats, timings));
  }
}

void run_render(RenderArguments& arguments) {
  read_calibration_into(arguments.sampling);
  std::vector<FrameJob> jobs = all_jobs(arguments.files, arguments.scene.shot);
  check_writable_files(arguments, jobs);

  const Stopwatch loading;
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  const std::string mark = mark_of(arguments, *scene);
  leave_what_is_there(arguments, mark, jobs);
  Timings timings;
  timings.load = loading.seconds();
  for (const std::string& warning : contents(*scene).warnings) say(arguments, "warning: " + warning);
  std::set<std::string> told;  // notes are much the same for every frame
  const Stopwatch rendering;
  for (size_t i = 0; i < jobs.size(); ++i) {
    render_job(arguments, jobs[i], {i, jobs.size()}, mark, *scene, timings, told);
    const size_t left = jobs.size() - i - 1;
    const double seconds = rendering.seconds() / static_cast<double>(i + 1) * static_cast<double>(left);
    const std::string outlook = left ? fmt::format("; {} of {}, {} left", i + 1, jobs.size(), clock_time(seconds)) : "";
    if (!jobs[i].out.empty()) say(arguments, fmt::format("wrote {}{}", jobs[i].out, outlook));
  }
}

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
          "Render these frames, each as with --frame; names of files then have %04d. Those that are there are skipped")
      ->type_name("A-B")
      ->excludes("--frame")
      ->excludes("--time");
  command
      .add_option_function<std::string>(
          "--part", [arguments](const std::string& text) { arguments->files.part = parse_part("--part", text); },
          "Render part I of N of the job, to be merged (kairos merge); of a Slurm array, the task's part")
      ->type_name("I/N|slurm")
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
    if (arguments->files.frames) {
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
