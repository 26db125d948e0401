// kairos study: methods of rendering compared, from scenes to a page.
#include <algorithm>
#include <memory>

#include <unistd.h>

#include <kairos/error.h>
#include <kairos/study.h>

#include "arguments.h"
#include "commands.h"
#include "interrupt.h"
#include "log.h"
#include "progress_bar.h"

namespace kairos::cli {

namespace {

struct StudyArguments {
  SceneArguments scene;
  study::StudyOptions options;
  std::string command_line;
  bool quick = false, quiet = false;
};

/// One line of status at the bottom of a terminal; in a file, a line now and then.
class StatusLine {
 public:
  explicit StatusLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
  ~StatusLine() { clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void show(const study::Status& status) {
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || now < next_) return;
    const std::string left = status.seconds_left ? ", " + clock_time(*status.seconds_left) + " left" : "";
    const double percent = std::clamp(status.fraction, 0.0, 1.0) * 100;
    if (terminal_)
      draw(fmt::format("\r{:3.0f} %  {}{}\x1b[K", percent, status.doing, left));
    else
      cli::log(fmt::format("{:3.0f} %  {}{}", percent, status.doing, left));
    next_ = now + (terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(15000));
  }
  void log(const std::string& line) {
    clear();
    if (!quiet_) cli::log(line);
  }

 private:
  void clear() const {
    if (terminal_ && !quiet_) draw("\r\x1b[K");
  }

  bool quiet_, terminal_;
  std::chrono::steady_clock::time_point next_{};
};

void run_study_command(const StudyArguments& arguments) {
  StatusLine line(arguments.quiet);
  begin_polling();
  const auto tell = [&](const study::Status& status) {
    line.show(status);
    return !interrupted();
  };
  try {
    study::run_study(arguments.options, arguments.command_line, tell, [&](const std::string& text) { line.log(text); });
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
    throw Error(ErrorCode::cancelled, "", "interrupted; the same command goes on from here");
  }
  end_polling();
  line.log("wrote " + arguments.options.folder + "/index.html");
}

/// Calls use(part) for each part between commas.
template <class Use>
void for_each_part(std::string_view text, const Use& use) {
  for (;;) {
    const size_t comma = text.find(',');
    use(text.substr(0, comma));
    if (comma == std::string_view::npos) return;
    text.remove_prefix(comma + 1);
  }
}

/// An option that takes different whole numbers, separated by commas.
CLI::Option* add_counts(CLI::App& app, const std::string& name, std::vector<int>& out, uint64_t least, uint64_t most,
                        const std::string& help) {
  std::string shown;
  for (const int value : out) shown += (shown.empty() ? "" : ",") + std::to_string(value);
  return app
      .add_option_function<std::string>(
          name,
          [&out, name, least, most](const std::string& text) {
            out.clear();
            for_each_part(text, [&](std::string_view part) {
              out.push_back(static_cast<int>(parse_count(name, part, least, most)));
            });
            std::sort(out.begin(), out.end());
            out.erase(std::unique(out.begin(), out.end()), out.end());
          },
          help)
      ->type_name("N,N,...")
      ->default_str(shown);
}

/// An option that takes different names of an enum, separated by commas.
template <class Enum>
CLI::Option* add_choices(CLI::App& app, const std::string& name, std::vector<Enum>& out, const std::string& help,
                         std::span<const Named<Enum>> offered = kNames<Enum>) {
  std::string shown;
  for (const Enum value : out) shown += (shown.empty() ? "" : ",") + std::string(to_string(value));
  return app
      .add_option_function<std::string>(
          name,
          [&out, offered, name](const std::string& text) {
            out.clear();
            for_each_part(text, [&](std::string_view part) {
              const Enum value = parse_choice<Enum>(name, part, offered);
              if (std::find(out.begin(), out.end(), value) != out.end())
                throw CLI::ValidationError(name, fmt::format("'{}' is named twice", part));
              out.push_back(value);
            });
          },
          help)
      ->type_name("A,B,...")
      ->default_str(shown);
}

/// What is not given on the command line gets less to do.
void make_quick(const CLI::App& app, StudyArguments& out) {
  const auto given = [&](const char* name) { return app.count(name) > 0; };
  study::StudyOptions& o = out.options;
  if (!given("--size")) {
    out.scene.shot.width = 192;
    out.scene.shot.height = 108;
  }
  if (!given("--seeds")) o.seeds = 3;
  if (!given("--budgets")) o.budgets = {4, 16, 64, 256};
  if (!given("--tc-rays")) o.tc_rays = {1, 2, 4, 8, 16};
  if (!given("--shading-samples")) o.shading_samples = {2, 8, 32};
  if (!given("--reference-spp")) o.reference_spp = 2048;
}

}  // namespace

void add_study_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  constexpr uint64_t kMostSamples = 1u << 20, kMostShadingSamples = 1u << 16, kMostKeys = 129;
  CLI::App& command = *app.add_subcommand(
      "study", "Compare methods of rendering: error against time, as a page with plots and pictures");
  const auto arguments = std::make_shared<StudyArguments>();
  arguments->command_line = command_line;
  study::StudyOptions& options = arguments->options;
  arguments->scene.threads = 1;
  arguments->scene.shot.width = 480;
  arguments->scene.shot.height = 270;
  add_scene_arguments(command, arguments->scene);
  command.get_option("SCENE")->description("glTF, GLB, OBJ, PLY, pbrt or native JSON; each file is a scene of its own");
  command.get_option("--size")->description("Size of the frames in pixels (default: 480x270)");
  command.get_option("--threads")->description("Threads of what is measured; 0: as many as the machine has");
  command.add_option("-o,--output", options.folder, "The folder to write to; a study begun there is continued")
      ->type_name("DIR")
      ->required();
  add_count(command, "--rows", options.rows, 0, 65536,
            "Render only so many rows of pixels, spread evenly over the frame; 0: all");
  add_choices(command, "--shading", options.shadings, "One study each: normal, flat, whitted, path", kSurfaceShadings);
  add_choices(command, "--methods", options.methods,
              "What is compared; random, multi-jitter and owen-sobol are samplers of qmc");
  add_counts(command, "--budgets", options.budgets, 1, kMostSamples, "Samples per pixel of qmc and auto");
  add_counts(command, "--tc-rays", options.tc_rays, 1, kMostSamples, "Time-continuous rays per pixel of tc and mixed");
  add_counts(command, "--shading-samples", options.shading_samples, 1, kMostShadingSamples,
             "Shading samples per time-continuous ray of tc");
  add_counts(command, "--keys", options.keys, 0, kMostKeys,
             "Motion keys to give Embree at least; the fastest of these is taken for each scene");
  add_count(command, "--seeds", options.seeds, 1, 1000, "How often everything is measured");
  add_count(command, "--reference-spp", options.reference_spp, 1, kMostSamples,
            "Samples per pixel of each half of the reference, at most");
  add_choice(command, "--clock", options.clock,
             "cpu: the processor's time; wall: time that passes (default: wall for more threads than one)");
  command.add_flag("--quick", arguments->quick, "Small pictures, few of them: two minutes for a small scene");
  command.add_flag("--force", options.force, "Throw away a study of other parameters in the folder");
  command.add_flag("--quiet", arguments->quiet, "No log and no progress, errors only");
  command.callback([arguments, &command, &chosen] {
    if (arguments->quick) make_quick(command, *arguments);
    study::StudyOptions& o = arguments->options;
    o.scenes = arguments->scene.paths;
    o.load = arguments->scene.load;
    o.shot = arguments->scene.shot;
    if (const std::optional<ShutterInterval>& shutter = arguments->scene.shutter) {
      if (shutter->in_seconds() && !o.shot.fps)
        throw CLI::ValidationError("--shutter", "is given in seconds: say with --fps how many frames they are");
      o.shot.shutter = shutter->in_frames(o.shot.fps.value_or(1));
    }
    o.shot.strict = o.load.strict;
    if (std::any_of(o.shadings.begin(), o.shadings.end(), is_lit)) o.shot.lights = LightChoice::automatic;
    o.threads = arguments->scene.threads;
    // Threads that wait for each other use no processor, and yet take time.
    if (o.threads != 1 && command.count("--clock") == 0) o.clock = study::Clock::wall;
    chosen = [arguments] { run_study_command(*arguments); };
  });
}

}  // namespace kairos::cli
