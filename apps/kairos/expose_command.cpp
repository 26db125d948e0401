// kairos expose: pictures of a file that holds time. kairos check: is it whole?
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/flow.h>
#include <kairos/object_layers.h>
#include <kairos/time_file.h>
#include <kairos/time_page.h>

#include "arguments.h"
#include "commands.h"
#include "frames.h"
#include "interrupt.h"
#include "log.h"
#include "progress_bar.h"
#include "shutter_arguments.h"
#include "time_arguments.h"
#include "view_arguments.h"

namespace kairos::cli {

namespace {

struct ExposeArguments {
  std::string file, out, command_line;
  WriteOptions write;
  ViewArguments view;
  std::optional<ShutterInterval> shutter;
  ExposureArguments exposure;
  std::optional<Duration> at;
  std::optional<FrameRange> frames;
  std::optional<double> fps;
  int stack = 0;     ///< pictures; 0: none
  std::string page;  ///< its file, or empty
  int page_width = ShutterPageOptions().width;
  bool coverage = false, depth = false, mesh = false, motion = false;  ///< further layers
  std::vector<MatteKind> mattes;
  enum class Deep { none, objects, segments } deep = Deep::none;
  bool quiet = false;

  bool needs_objects() const { return depth || mesh || deep == Deep::objects || !mattes.empty(); }
  int threads = 0;
};

void say(const ExposeArguments& arguments, const std::string& line) {
  if (!arguments.quiet) cli::log(line);
}

/// A picture to make: of a shutter, or of an instant.
struct PictureJob {
  std::string out;
  double frame_time = 0;  ///< scene time from which the times below are counted
  Shutter shutter;
  std::optional<double> instant;
};

struct Exposed {
  Image image;
  ExposedObjects objects;  ///< empty where nobody needs them
  PixelWeights weights;    ///< of an exposure
};

Exposed expose(const ExposeArguments& arguments, const TimePicture& picture, const PictureJob& job,
               const ExposeOptions& options) {
  const TimeFrame& frame = picture.frame();
  Image image;
  ExposedObjects objects;
  PixelWeights weights;
  if (job.instant || frame.open == frame.close) {
    const double time = job.frame_time + job.instant.value_or(job.shutter.open);
    check_recorded(arguments.file, frame, time, time);
    const double length = frame.close - frame.open;
    const double shutter_time = length > 0 ? std::clamp((time - frame.open) / length, 0.0, 1.0) : 0;
    image = picture.at(shutter_time, options);
    if (arguments.needs_objects()) objects = picture.objects_at(shutter_time, options);
    image.attributes.push_back({"kairos:instant", time});
  } else {
    const ExposureInterval whole = whole_interval(job.shutter, frame.frame_width, frame.frame_height);
    check_recorded(arguments.file, frame, job.frame_time + whole.open, job.frame_time + whole.close);
    const Exposure exposure(job.shutter, job.frame_time, frame.frame_width, frame.frame_height, frame.open,
                            frame.close);
    weights = pixel_weights(exposure);
    image = picture.expose(weights, options);
    if (arguments.needs_objects()) objects = picture.objects(weights, options);
    const std::string text = shutter_text(job.shutter, frame.frame_width, frame.frame_height);
    image.attributes.push_back({"kairos:exposed", text});
    image.attributes.push_back({"kairos:exposure", std::array<double, 2>{job.shutter.open, job.shutter.close}});
    image.attributes.push_back({"kairos:exposure_frame_time", job.frame_time});
    image.attributes.push_back(
        {"kairos:exposure_line", std::array<double, 2>{job.shutter.open_line, job.shutter.close_line}});
    std::erase_if(image.attributes, [](const Attribute& attribute) { return attribute.name == "expTime"; });
    image.attributes.push_back({"expTime", job.shutter.close - job.shutter.open});
    if (!arguments.frames && arguments.stack == 0) say(arguments, text);
  }
  image.attributes.push_back({"kairos:exposed_with", arguments.command_line});
  if (arguments.depth) add_depth(image, objects);
  if (arguments.mesh) add_mesh_ids(image, objects);
  for (const MatteKind kind : arguments.mattes) add_cryptomatte(image, objects, frame, kind);
  return {std::move(image), std::move(objects), std::move(weights)};
}

/// Where the point that a pixel's centre shows in the middle of its exposure is at the exposure's end, and where it was
/// at its beginning: channels "forward.u", "forward.v", "backward.u", "backward.v", as flow's. Lines of a rolling
/// shutter have instants of their own.
void add_motion(const ExposeArguments& arguments, const TimeFile& file, const PictureJob& job,
                const std::function<bool(double)>& progress, Image& image) {
  const TimeFrame& frame = file.picture().frame();
  const ExposureInterval whole = whole_interval(job.shutter, frame.frame_width, frame.frame_height);
  const auto recorded = [&](double time) { return std::clamp(job.frame_time + time, frame.open, frame.close); };
  const Shot shot = file.shot(recorded(whole.open), recorded(whole.close));
  const Exposure exposure(job.shutter, job.frame_time, frame.frame_width, frame.frame_height, shot.shutter_open,
                          shot.shutter_close);
  FlowOptions options;
  options.threads = arguments.threads;
  options.progress = progress;
  for (const bool backward : {false, true}) {
    options.times = [&, backward](int x, int y) -> std::array<double, 2> {
      const TimeWeight weight = exposure.weight(x, y);
      const double begin = weight.begin(), end = std::min(weight.end(), 1.0);
      return {(begin + end) / 2, backward ? begin : end};
    };
    const Image flow_all = flow(shot, options);
    for (const char* axis : {"u", "v"}) {
      const std::vector<float>& values = flow_all.find(std::string("flow.") + axis)->values;
      Channel channel{std::string(backward ? "backward." : "forward.") + axis, Channel::Storage::exact, {}};
      for (int y = 0; y < image.height; ++y) {
        const auto row = values.begin() + static_cast<std::ptrdiff_t>(y + image.top) * image.frame_width + image.left;
        channel.values.insert(channel.values.end(), row, row + image.width);
      }
      image.channels.push_back(std::move(channel));
    }
  }
}

void write_page(const ExposeArguments& arguments, const TimePicture& picture) {
  check_writable(arguments.page);
  ShutterPageOptions options;
  options.file = std::filesystem::path(arguments.file).filename().string();
  options.width = arguments.page_width;
  options.threads = arguments.threads;
  WorkProgress work(arguments.quiet, 1);
  options.progress = work.of_piece();
  begin_polling();
  const std::string page = shutter_page(picture, options);
  end_polling();
  write_file(arguments.page, page);
  say(arguments,
      fmt::format("wrote {}, {:.1f} MB: open it in a browser", arguments.page, static_cast<double>(page.size()) / 1e6));
}

std::vector<PictureJob> jobs_of(const ExposeArguments& arguments, const TimeFrame& frame) {
  const auto shutter = [&](const std::array<double, 2>& interval, double fps) {
    return shutter_of(arguments.exposure, interval, fps, frame.frame_width, frame.frame_height);
  };
  const auto seconds = [&](double fps) -> std::array<double, 2> {
    const auto interval = arguments.shutter->in_frames(fps);
    return {interval[0] / fps, interval[1] / fps};
  };
  const std::array<double, 2> all{frame.open - frame.frame_time, frame.close - frame.frame_time};
  const double fps = arguments.fps.value_or(frame.fps);
  if (arguments.at) return {{arguments.out, frame.frame_time, {}, arguments.at->in_seconds(fps)}};
  std::vector<PictureJob> jobs;
  if (arguments.frames) {
    const FrameName out("--output", arguments.out);
    const std::array<double, 2> interval = arguments.shutter ? seconds(fps) : std::array<double, 2>{0, 0.5 / fps};
    for (int i = arguments.frames->first; i <= arguments.frames->last; ++i)
      jobs.push_back({out.at(i), i / fps, shutter(interval, fps), std::nullopt});
  } else if (arguments.stack > 0) {
    const FrameName out("--output", arguments.out);
    const double step = (all[1] - all[0]) / arguments.stack;
    for (int i = 0; i < arguments.stack; ++i)
      jobs.push_back(
          {out.at(i), frame.frame_time, shutter({all[0] + i * step, all[0] + (i + 1) * step}, fps), std::nullopt});
  } else {
    jobs.push_back(
        {arguments.out, frame.frame_time, shutter(arguments.shutter ? seconds(fps) : all, fps), std::nullopt});
  }
  return jobs;
}

void run_expose(const ExposeArguments& arguments) {
  const bool once = !arguments.frames && arguments.stack == 0 && arguments.page.empty();
  const TimeFile file = once ? TimeFile::open(arguments.file, 0) : TimeFile::open(arguments.file);
  const TimePicture& picture = file.picture();
  if (!file.info().finished)
    say(arguments, fmt::format("warning: {}: is not finished, {} of {} tiles are there; the others stay black",
                               arguments.file, file.info().tiles_there, file.info().tiles));
  if (!arguments.page.empty()) write_page(arguments, picture);
  if (arguments.out.empty()) return;
  const std::vector<PictureJob> jobs = jobs_of(arguments, picture.frame());
  for (const PictureJob& job : jobs) check_writable_image(job.out);
  if (arguments.needs_objects() && !picture.has_objects())
    throw Error(ErrorCode::bad_input, arguments.file,
                "does not hold what each object contributes, which depth, mesh, --cryptomatte and --deep are made of; "
                "render it again with --time-planes objects");
  if (arguments.deep == ExposeArguments::Deep::segments && !file.has_rays())
    throw Error(
        ErrorCode::bad_input, arguments.file,
        "does not hold what each ray sees, which --deep segments is made of; render it again with --time-planes "
        "rays");
  if (arguments.motion && !file.has_geometry())
    throw Error(ErrorCode::bad_input, arguments.file,
                "does not hold where things are, which motion is made of; render it again with --time-planes geometry");
  if (arguments.at && !picture.quality().exact())
    say(arguments,
        "note: what this file holds is exact for exposures, within its tolerance, and not for an instant; see "
        "--time-tolerance exact of kairos render");
  ExposeOptions options;
  options.coverage = arguments.coverage;
  options.threads = arguments.threads;
  WorkProgress work(arguments.quiet, jobs.size());
  options.progress = work.of_piece();
  begin_polling();
  for (const PictureJob& job : jobs) {
    Exposed exposed = expose(arguments, picture, job, options);
    if (arguments.motion) add_motion(arguments, file, job, options.progress, exposed.image);
    WriteOptions write = arguments.write;
    write.view = arguments.view.choice.value_or(picture.frame().view);
    write.exposure = arguments.view.exposure;
    const auto go_on = [] { return !interrupted(); };
    if (arguments.deep == ExposeArguments::Deep::objects)
      write_deep_image(deep_objects(exposed.image, exposed.objects, picture.frame()), job.out, go_on);
    else if (arguments.deep == ExposeArguments::Deep::segments)
      write_deep_image(deep_segments(exposed.image, file, exposed.weights, options.progress), job.out, go_on);
    else
      write_interruptibly(exposed.image, job.out, write);
    begin_polling();
    work.next();
    say(arguments, "wrote " + job.out);
  }
  end_polling();
}

}  // namespace

void add_expose_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("expose", "Make pictures of a file that holds time");
  const auto arguments = std::make_shared<ExposeArguments>();
  arguments->command_line = command_line;
  command.add_option("FILE", arguments->file, "A picture over time, .ktime")->required();
  command
      .add_option("-o,--output", arguments->out, "The picture to write; with --frames and --stack, %04d is a number")
      ->type_name("OUT.exr|OUT.png");
  command
      .add_option("--page", arguments->page,
                  "Write a page on which the shutter is dragged, and the picture changes at once; in place of -o, or "
                  "beside it")
      ->type_name("OUT.html");
  add_count(command, "--page-width", arguments->page_width, 1, 4096,
            "Pixels across of the page's picture, at most; wider ones are reduced")
      ->needs("--page");
  add_shutter(command, arguments->shutter);
  add_exposure_options(command, arguments->exposure);
  command
      .add_option_function<std::string>(
          "--at", [arguments](const std::string& text) { arguments->at = parse_duration("--at", text); },
          "What is seen at an instant: a time from the frame's, with --shutter's units")
      ->type_name("TIME")
      ->excludes("--shutter");
  command
      .add_option_function<std::string>(
          "--frames", [arguments](const std::string& text) { arguments->frames = parse_frames("--frames", text); },
          "These frames, of --fps; each exposed as --shutter says, for half a frame without it")
      ->type_name("A-B")
      ->excludes("--at");
  command
      .add_option_function<std::string>(
          "--fps",
          [arguments](const std::string& text) {
            arguments->fps = parse_real("--fps", text);
            if (!(*arguments->fps > 0)) throw CLI::ValidationError("--fps", "must be above 0");
          },
          "Frames per second (default: those it was rendered with)")
      ->type_name("R");
  add_count(command, "--stack", arguments->stack, 0, 100000,
            "So many pictures of equal parts of all the time that the file holds, numbered from 0")
      ->excludes("--at")
      ->excludes("--frames")
      ->excludes("--shutter");
  command
      .add_option_function<std::string>(
          "--aov",
          [arguments](const std::string& text) {
            for (const std::string_view name : list_of(text)) {
              const std::map<std::string_view, bool*> known{{"coverage", &arguments->coverage},
                                                            {"depth", &arguments->depth},
                                                            {"mesh", &arguments->mesh},
                                                            {"motion", &arguments->motion}};
              if (!known.contains(name))
                throw CLI::ValidationError("--aov",
                                           fmt::format("'{}' is not one of: coverage, depth, mesh, motion", name));
              *known.at(name) = true;
            }
          },
          "Further EXR layers, separated by commas: coverage; where the file holds objects, depth and mesh; where "
          "it holds geometry, motion")
      ->type_name("A,B,...");
  command
      .add_option_function<std::string>(
          "--cryptomatte",
          [arguments](const std::string& text) {
            for (const std::string_view name : list_of(text)) {
              if (name != "object" && name != "material")
                throw CLI::ValidationError("--cryptomatte", fmt::format("'{}' is not one of: object, material", name));
              arguments->mattes.push_back(name == "object" ? MatteKind::object : MatteKind::material);
            }
          },
          "Layers of Cryptomatte: how much of each object or material the exposure shows, exactly")
      ->type_name("object,material");
  command
      .add_option_function<std::string>(
          "--deep",
          [arguments](const std::string& text) {
            if (text != "object" && text != "segments")
              throw CLI::ValidationError("--deep", fmt::format("'{}' is not one of: object, segments", text));
            arguments->deep = text == "object" ? ExposeArguments::Deep::objects : ExposeArguments::Deep::segments;
          },
          "Write deep EXR, a sample for each object in a pixel, or for each segment that a ray sees; composited, they "
          "are the exposure")
      ->type_name("object|segments")
      ->excludes("--aov")
      ->excludes("--cryptomatte");
  add_view_options(command, arguments->view);
  command.add_flag("--half", arguments->write.half, "16-bit colours in EXR");
  add_count(command, "--threads", arguments->threads, 0, 1024, "Threads; 0: as many as the machine has");
  command.add_flag("--quiet", arguments->quiet, "No log, errors only");
  command.callback([arguments, &chosen, &command] {
    if (arguments->out.empty() && arguments->page.empty()) throw CLI::RequiredError("--output");
    check_view(command, arguments->out);
    if (arguments->deep == ExposeArguments::Deep::segments && arguments->at)
      throw CLI::ValidationError("--deep", "segments are those of an exposure; give --shutter");
    const bool layers = arguments->needs_objects() || arguments->deep != ExposeArguments::Deep::none ||
                        arguments->coverage || arguments->motion;
    if (arguments->motion && arguments->at)
      throw CLI::ValidationError("--aov", "motion is that of an exposure; for instants there is kairos flow");
    if (layers && !arguments->out.ends_with(".exr"))
      throw CLI::ValidationError("--output", "further layers are those of EXR; give a name with .exr");
    if (arguments->frames || arguments->stack > 0) FrameName::check("--output", arguments->out);
    chosen = [arguments] { run_expose(*arguments); };
  });
}

void add_check_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("check", "Read all of a file that holds time: is it as it was written?");
  const auto file = std::make_shared<std::string>();
  command.add_option("FILE", *file, "A picture over time, .ktime")->required();
  command.callback([file, &chosen] {
    chosen = [file] {
      const TimeFile read = TimeFile::open(*file);
      read.check();
      fmt::print("{}: {} of {} tiles, all as they were written{}\n", *file, read.info().tiles_there, read.info().tiles,
                 read.info().finished ? "" : "; rendering has not come to its end");
    };
  });
}

}  // namespace kairos::cli
