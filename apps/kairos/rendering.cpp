#include "rendering.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <vector>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/picture.h>
#include <kairos/render.h>
#include <kairos/scene_files.h>
#include <kairos/time_file.h>

#include "checkpoint.h"
#include "frame_mark.h"
#include "interrupt.h"
#include "log.h"
#include "parts.h"
#include "render_stats.h"
#include "report.h"
#include "time_arguments.h"

namespace kairos::cli {

namespace {

void say(const RenderArguments& arguments, const std::string& line) {
  if (!arguments.quiet) log(line);
}

uint64_t total_rays(const RenderParams& params, const Shot& shot) {
  const Crop crop = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
  const int per_pixel = params.integrator == IntegratorKind::tc ? params.tc_rays : params.spp;
  return static_cast<uint64_t>(crop.x1 - crop.x0) * static_cast<uint64_t>(crop.y1 - crop.y0) *
         static_cast<uint64_t>(per_pixel);
}

/// What is asked for in vain, or is hardly meant.
std::vector<std::string> doubtful_wishes(const RenderArguments& arguments) {
  const RenderParams& params = arguments.sampling.params;
  const bool over_time = params.integrator != IntegratorKind::qmc;
  std::vector<std::string> notes;
  if (params.shadows == Shadows::exact && !(over_time && is_lit(params.shading)))
    notes.push_back("--shadows exact does nothing here: it is for lit pictures by tc, mixed or auto");
  if (params.mirrors == Mirrors::exact && !(over_time && params.shading == ShadingKind::whitted))
    notes.push_back("--mirrors exact does nothing here: it is for --shading whitted by tc, mixed or auto");
  if (params.cells == Cells::on && !is_lit(params.shading))
    notes.push_back("--cells on does nothing here: it is for lit pictures");
  constexpr double kLikelyAngle = 45;
  if (const auto& shutter = arguments.scene.shutter;
      shutter && shutter->length && !shutter->length->seconds && shutter->length->value >= kLikelyAngle)
    notes.push_back(
        fmt::format("the shutter is open for {0:g} frames; an angle is written {0:g}deg", shutter->length->value));
  return notes;
}

/// Which of how many jobs.
struct Place {
  size_t number = 0, count = 1;
};

/// work: what renders, and tells how far it is.
void with_progress(const RenderArguments& arguments, Place place, uint64_t rays,
                   const std::function<void(const Progress&)>& work) {
  std::unique_ptr<ProgressBar> bar;
  bool begun = false;
  const auto progress = [&](double fraction) {
    if (!begun) begin_polling();  // rendering has begun: before, a signal ends the program at once
    begun = true;
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
std::string mark_of(const RenderArguments& arguments, const RenderFiles& out, const Scene& scene) {
  const bool several = out.frames || out.part || arguments.checkpoint || !out.time.empty();
  if (!several) return "";
  std::vector<std::string> files = kairos::files(scene);
  if (arguments.sampling.calibration != kDefaultCalibration) files.push_back(arguments.sampling.calibration);
  if (!arguments.sampling.exposure.map.empty()) files.push_back(arguments.sampling.exposure.map);
  if (arguments.light.environment) files.push_back(arguments.light.environment->path);
  return frame_mark(
      *arguments.command,
      {"SCENE", "--output", out.time.empty() ? "--frames" : "--output", "--stats-file", "--calibration",
       "--environment", "--interval-map", "--threads", "--quiet", "--time", "--part", "--checkpoint", "--progress"},
      files);
}

/// Before the scene is loaded, which may take long: can all that is to be written be written?
void check_writable_files(const RenderFiles& files, const std::vector<FrameJob>& jobs) {
  const bool again = files.frames || files.part;  // what is there may stay as it is
  for (const FrameJob& job : jobs) {
    for (const std::string& path : {job.out, job.time})
      if (job.part && !path.empty()) make_parts_folder(path);
    if (!job.out.empty() && !(again && std::filesystem::is_regular_file(job.out))) check_writable_image(job.out);
    if (!job.stats_file.empty()) check_writable(job.stats_file);
  }
}

/// Leaves those that are not done yet. Pictures get their name when they are complete: what is there need not be made
/// again, unless a disk lost some of it.
void leave_what_is_there(const RenderArguments& arguments, const RenderFiles& files, const std::string& mark,
                         std::vector<FrameJob>& jobs) {
  if (!files.frames && !files.part) return;
  const size_t count = jobs.size();
  std::erase_if(jobs, [&](const FrameJob& job) {
    const bool found = is_there(job, mark);
    for (const std::string& path : {job.out, job.time})
      if (!found && job.stats_file.empty() && !path.empty() && std::filesystem::is_regular_file(path))
        say(arguments, path + " is no whole picture: it is made again");
    return found;
  });
  if (jobs.size() < count)
    say(arguments,
        fmt::format("{} of {} {} are there already", count - jobs.size(), count, files.part ? "parts" : "frames"));
}

ExposedShot exposed_of(const RenderArguments& arguments, const FrameJob& job, const Scene& scene) {
  SceneArguments of_job = arguments.scene;
  of_job.shot = job.shot;
  if (job.slabs > 0) of_job.shutter = ShutterInterval{{0, false}, {static_cast<double>(job.slabs), false}, {}};
  return exposed_shot(of_job, arguments.sampling.exposure, scene);
}

Shot shot_of(const RenderArguments& arguments, const Scene& scene, const ShotOptions& options) {
  Shot shot = make_shot(scene, options);
  arguments.light.background.apply(shot);
  return shot;
}

/// What is made of the scene for a frame, and kept for its other parts.
struct Frame {
  std::optional<double> number;
  int slabs;  ///< FrameJob::slabs
  ExposedShot exposed;
  Shot shot;
  RenderParams params;  ///< of the whole
  double seconds = 0;   ///< that making the shot took
  Renderer renderer;

  Frame(const RenderArguments& arguments, const FrameJob& job, const Scene& scene, const Stopwatch& making)
      : number(job.shot.frame),
        slabs(job.slabs),
        exposed(exposed_of(arguments, job, scene)),
        shot(shot_of(arguments, scene, exposed.options)),
        params(arguments.sampling.params),
        renderer(shot) {
    params.exposure = exposed.exposure(shot);
    seconds = making.seconds();
  }
};

/// Does jobs, one after the other, with one scene.
class Rendering {
 public:
  explicit Rendering(const RenderArguments& arguments) : arguments_(arguments) {}

  /// What the files ask for.
  void run(const RenderFiles& files);

 private:
  void load(const RenderFiles& files);
  const Frame& frame_of(const FrameJob& job);
  void render(const RenderFiles& files, const FrameJob& job, Place place);
  std::unique_ptr<TimeFileWriter> time_file(const Shot& shot, const ShotOptions& options, const FrameJob& job);
  void render_slabs(const FrameJob& job);
  void finish(TimeFileWriter& time, const FrameJob& job);
  void render_checkpointed(const Frame& frame, const FrameJob& job, Place place, const WriteOptions& write, int number);

  const RenderArguments& arguments_;
  std::shared_ptr<const Scene> scene_;
  std::string mark_;
  Timings timings_;
  std::unique_ptr<Frame> frame_;  // of the job before
  std::set<std::string> told_;    // notes are much the same for every frame
};

void Rendering::load(const RenderFiles& files) {
  const Stopwatch loading;
  scene_ = load_scene(arguments_.scene.paths, arguments_.scene.load);
  mark_ = mark_of(arguments_, files, *scene_);
  timings_.load = loading.seconds();
  for (const std::string& warning : contents(*scene_).warnings) say(arguments_, "warning: " + warning);
}

const Frame& Rendering::frame_of(const FrameJob& job) {
  if (frame_ && frame_->number == job.shot.frame && frame_->slabs == job.slabs) return *frame_;
  frame_.reset();  // before there is another one
  frame_ = std::make_unique<Frame>(arguments_, job, *scene_, Stopwatch());
  const Shot& shot = frame_->shot;
  const Projection& size = shot.projection;
  say(arguments_,
      fmt::format("loaded {}, {} in {:.2f} s; {}x{} pixels, shutter {} to {}",
                  amount(shot.meshes.size(), "mesh", "meshes"),
                  amount(triangle_count(shot.meshes), "triangle", "triangles"), timings_.load + frame_->seconds,
                  size.width, size.height, shot.shutter_open, shot.shutter_close));
  if (frame_->exposed.shutter) say(arguments_, shutter_text(*frame_->exposed.shutter, size.width, size.height));
  for (const std::vector<std::string>& notes : {shot.notes, doubtful_wishes(arguments_)})
    for (const std::string& note : notes)
      if (told_.insert(note).second) say(arguments_, "note: " + note);
  return *frame_;
}

void Rendering::render_checkpointed(const Frame& frame, const FrameJob& job, Place place, const WriteOptions& write,
                                    int number) {
  MergedPicture merged;
  with_progress(arguments_, place, total_rays(frame.params, frame.shot), [&](const Progress& progress) {
    merged = render_with_checkpoints(
        {frame.shot, frame.params, job.out, mark_, arguments_.command_line, number, write, *arguments_.checkpoint},
        progress);
  });
  write_interruptibly(merged.image, job.out, write);
  remove_parts(merged.parts, job.out);
}

/// shot: of all of the file's time. A part holds some tiles of the whole.
std::unique_ptr<TimeFileWriter> Rendering::time_file(const Shot& shot, const ShotOptions& shot_options,
                                                     const FrameJob& job) {
  TimeFileOptions options = arguments_.time_options;
  options.clock = clock_of(shot_options, contents(*scene_));
  options.mark = mark_;
  options.slabs = std::max(1, job.slabs);
  auto time = std::make_unique<TimeFileWriter>(job.time, shot, arguments_.sampling.params, options);
  const auto is_cut_out = [](const Material& m) { return m.alpha_mode == Material::AlphaMode::mask; };
  if (options.geometry && std::any_of(shot.materials.begin(), shot.materials.end(), is_cut_out))
    say(arguments_, "note: the geometry of '" + job.time +
                        "' has no cut-outs: flow takes surfaces as whole; kairos flow SCENE does not");
  if (time->tiles_before() > 0)
    say(arguments_,
        fmt::format("{} of {} tiles are in '{}.part' already", time->tiles_before(), time->tiles(), job.time));
  return time;
}

void Rendering::finish(TimeFileWriter& time, const FrameJob& job) {
  if (job.part)
    time.finish_part();
  else
    time.finish();
  say(arguments_, job.part ? "wrote " + job.time : time_file_text(job.time));
}

/// A file of many frames: each is a slab of its time, and a shot of its own.
void Rendering::render_slabs(const FrameJob& job) {
  FrameJob of_slab = job;
  of_slab.slabs = 1;
  // Where everything is in all of the time; where that is not kept, the first frame says what the file is of.
  const ShotOptions options = exposed_of(arguments_, arguments_.time_options.geometry ? job : of_slab, *scene_).options;
  Shot all = shot_of(arguments_, *scene_, options);
  all.shutter_close = all.shutter_open + job.slabs / clock_of(options, contents(*scene_)).fps;
  const Crop frame_pixels{0, all.projection.width, 0, all.projection.height};
  const std::unique_ptr<TimeFileWriter> time = time_file(all, options, job);
  all = {};
  for (int slab = 0; slab < job.slabs; ++slab) {
    if (time->slab_is_there(slab)) continue;
    of_slab.shot.frame = *job.shot.frame + slab;
    const Frame& frame = frame_of(of_slab);
    RenderParams params = frame.params;
    if (job.part) params.crop = pixels_of(job, params.crop.value_or(frame_pixels));
    time->begin_slab(slab);
    PixelConsumer* const consumers[] = {time.get()};
    with_progress(arguments_, {static_cast<size_t>(slab), static_cast<size_t>(job.slabs)},
                  total_rays(params, frame.shot),
                  [&](const Progress& progress) { frame_->renderer.render(params, consumers, nullptr, progress); });
  }
  frame_.reset();
  finish(*time, job);
}

void Rendering::render(const RenderFiles& files, const FrameJob& job, Place place) {
  if (job.slabs > 0) return render_slabs(job);
  const Frame& frame = frame_of(job);
  const Shot& shot = frame.shot;
  RenderParams params = frame.params;
  const Crop whole = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
  if (job.part) params.crop = pixels_of(job, whole);
  WriteOptions write = arguments_.write;
  write.view = arguments_.view.choice.value_or(usual_view(shot, params.shading));
  write.exposure = arguments_.view.exposure;
  const int number = files.frames ? static_cast<int>(*job.shot.frame) : -1;
  if (arguments_.checkpoint) return render_checkpointed(frame, job, place, write, number);

  RenderStats stats;
  std::optional<Picture> picture;
  std::unique_ptr<TimeFileWriter> time;
  std::vector<PixelConsumer*> consumers;
  RenderParams of_rays = params;
  if (!job.out.empty()) consumers.push_back(&picture.emplace(shot.projection, params));
  if (!job.time.empty()) {
    of_rays.exposure.reset();  // rays look at all of the time that the file holds
    time = time_file(shot, frame.exposed.options, job);
    consumers.push_back(time.get());
  }
  with_progress(arguments_, place, total_rays(params, shot),
                [&](const Progress& progress) { frame_->renderer.render(of_rays, consumers, &stats, progress); });
  say(arguments_,
      fmt::format("built in {:.2f} s, rendered {} rays in {:.2f} s ({}rays/s) on {} threads, {}", stats.build_seconds,
                  stats.rays, stats.render_seconds, with_unit(static_cast<double>(stats.rays) / stats.render_seconds),
                  stats.threads,
                  stats.instruction_set ? fmt::format("instruction set {}", to_string(*stats.instruction_set))
                                        : std::string("Embree")));

  const Stopwatch writing;
  if (time) finish(*time, job);
  if (picture) {
    Image image = picture->take_shown();
    describe(image, shot, params, stats);
    image.attributes.push_back({"kairos:command_line", arguments_.command_line});
    if (job.part)
      describe_part(image, *job.part, number, mark_, write);
    else if (files.frames)
      image.attributes.push_back({kFrameMarkName, mark_});
    write_interruptibly(image, job.out, job.part ? part_options(files.out, write) : write);
  }
  Timings timings = timings_;
  timings.shot = frame.seconds;
  timings.write = writing.seconds();
  if (!job.stats_file.empty()) write_file(job.stats_file, stats_text(params, shot, stats, timings));
}

void Rendering::run(const RenderFiles& files) {
  std::vector<FrameJob> jobs = all_jobs(files, arguments_.scene.shot);
  check_writable_files(files, jobs);
  if (!scene_) load(files);
  leave_what_is_there(arguments_, files, mark_, jobs);
  const Stopwatch rendering;
  for (size_t i = 0; i < jobs.size(); ++i) {
    render(files, jobs[i], {i, jobs.size()});
    const size_t left = jobs.size() - i - 1;
    const double seconds = rendering.seconds() / static_cast<double>(i + 1) * static_cast<double>(left);
    const std::string outlook = left ? fmt::format("; {} of {}, {} left", i + 1, jobs.size(), clock_time(seconds)) : "";
    if (!jobs[i].out.empty()) say(arguments_, fmt::format("wrote {}{}", jobs[i].out, outlook));
  }
}

}  // namespace

void run_render(RenderArguments& arguments) {
  read_calibration_into(arguments.sampling);
  Rendering rendering(arguments);
  if (!arguments.parts_from_input) return rendering.run(arguments.files);
  for (std::string line; std::getline(std::cin, line);) {
    RenderFiles files = arguments.files;
    files.part = parse_part("--part", line);
    rendering.run(files);
    std::cout << line << std::endl;
  }
}

}  // namespace kairos::cli
