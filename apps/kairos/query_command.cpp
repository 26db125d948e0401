// kairos query: rays in, visibility segments out.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include <kairos/error.h>

#include "arguments.h"
#include "commands.h"
#include "light_arguments.h"
#include "pixel_query.h"
#include "ray_reader.h"
#include "sampling_arguments.h"

namespace kairos::cli {

namespace {

constexpr size_t kRaysPerBatch = 4096;

struct QueryArguments {
  SceneArguments scene;
  std::string rays;
  bool all = false, occluded = false;
  TraceLimits limits;
  std::optional<std::array<int, 2>> pixel;
  SamplingArguments sampling;
  LightArguments light;
};

TracerOptions options_of(const QueryArguments& arguments) {
  TracerOptions options;
  options.instruction_set = arguments.sampling.params.instruction_set;
  options.threads = arguments.scene.threads;
  return options;
}

// Writes the answers to rays, one line each.
class Answerer {
 public:
  Answerer(const Shot& shot, const QueryArguments& arguments)
      : shot_(shot),
        visibility_(arguments.all ? Visibility::all : Visibility::visible),
        occluded_(arguments.occluded),
        limits_(arguments.limits),
        tracer_(shot.meshes, options_of(arguments)) {
    for (const Mesh& mesh : shot.meshes)
      names_.push_back(nlohmann::json(mesh.name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  void answer(const std::vector<Ray>& rays) {
    text_.clear();
    if (occluded_)
      say_occluded(rays);
    else
      say_segments(rays);
    if (std::fwrite(text_.data(), 1, text_.size(), stdout) != text_.size() || std::fflush(stdout) != 0)
      throw Error(ErrorCode::io, "standard output", std::string("cannot be written: ") + std::strerror(errno));
  }

 private:
  /// JSON has no number for what is beyond the largest float.
  static std::string distance(float dist) { return std::isfinite(dist) ? fmt::format("{}", dist) : "null"; }

  void say_segments(const std::vector<Ray>& rays) {
    const SegmentBatch batch = tracer_.trace(rays, visibility_, nullptr, limits_);
    for (size_t i = 0; i < rays.size(); ++i) {
      text_.append(std::string_view("{\"segments\": ["));
      bool first = true;
      for (const Segment& s : batch[i]) {
        // "{}" of a float: the shortest text that reads back as the same number.
        fmt::format_to(
            std::back_inserter(text_),
            "{}{{\"begin\": {}, \"end\": {}, \"dist_begin\": {}, \"dist_end\": {}, \"mesh\": {}, \"prim\": {}, "
            "\"front\": {}}}",
            first ? "" : ", ", s.begin, s.end, distance(s.dist_begin), distance(s.dist_end), names_[s.mesh],
            shot_.meshes[s.mesh].prim_id(s.triangle), s.front);
        first = false;
      }
      text_.append(std::string_view("]}\n"));
    }
  }
  void say_occluded(const std::vector<Ray>& rays) {
    for (const Ray& ray : rays) {
      text_.append(std::string_view("{\"occluded\": ["));
      bool first = true;
      for (const TimeRange& range : tracer_.occluded(ray, workspace_, limits_)) {
        fmt::format_to(std::back_inserter(text_), "{}{{\"begin\": {}, \"end\": {}}}", first ? "" : ", ", range.begin,
                       range.end);
        first = false;
      }
      text_.append(std::string_view("]}\n"));
    }
  }

  const Shot& shot_;
  Visibility visibility_;
  bool occluded_;
  TraceLimits limits_;
  Tracer tracer_;
  Tracer::Workspace workspace_;
  std::vector<std::string> names_;  // as JSON
  fmt::memory_buffer text_;
};

void answer_all(RayReader& reader, Answerer& answerer) {
  std::vector<Ray> rays;
  Ray ray;
  try {
    while (reader.next(ray)) {
      rays.push_back(ray);
      if (rays.size() < kRaysPerBatch && reader.more_at_hand()) continue;
      answerer.answer(rays);
      rays.clear();
    }
  } catch (const Error& e) {
    // What came before a bad line has its answers.
    if (e.code() == ErrorCode::bad_input && !rays.empty()) answerer.answer(rays);
    throw;
  }
  if (!rays.empty()) answerer.answer(rays);
}

void read_window(const std::string& text, TraceLimits& limits) {
  const auto parts = split("--window", text, ',', 2, "BEGIN,END");
  limits.window_begin = static_cast<float>(parse_real("--window", parts[0]));
  limits.window_end = static_cast<float>(parse_real("--window", parts[1]));
  if (!(limits.window_begin >= 0 && limits.window_begin < limits.window_end && limits.window_end <= 1))
    throw CLI::ValidationError("--window", "is not inside the shutter; give 0 <= BEGIN < END <= 1");
}

void read_max_dist(const std::string& text, TraceLimits& limits) {
  limits.max_dist = static_cast<float>(parse_real("--max-dist", text));
  if (!(limits.max_dist > 0)) throw CLI::ValidationError("--max-dist", "is not positive; give how far rays look");
}

void read_pixel(const std::string& text, QueryArguments& arguments) {
  constexpr uint64_t kMost = 65535;
  const auto parts = split("--pixel", text, ',', 2, "X,Y");
  const auto side = [&](size_t i) { return static_cast<int>(parse_count("--pixel", parts[i], 0, kMost)); };
  arguments.pixel = {side(0), side(1)};
}

void run_query(QueryArguments arguments) {
  if (arguments.pixel)
    return run_pixel_query(arguments.scene, arguments.sampling, arguments.light.background, *arguments.pixel);
  std::ifstream file;
  const bool standard_input = arguments.rays == "-";
  if (!standard_input) {
    file.open(arguments.rays, std::ios::binary);
    if (!file) throw Error(ErrorCode::io, arguments.rays, "cannot be opened for reading; check the name");
  }
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  for (const std::string& warning : contents(*scene).warnings) std::cerr << "warning: " << warning << '\n';
  arguments.scene.shot.space = ShotOptions::Space::world;
  const Shot shot = make_shot(*scene, shot_options(arguments.scene, *scene));
  Answerer answerer(shot, arguments);
  std::ios::sync_with_stdio(false);  // else standard input does not say how much of it is at hand
  RayReader reader(standard_input ? std::cin : file, standard_input ? "standard input" : arguments.rays);
  answer_all(reader, answerer);
}

/// Either rays or a pixel, and no option that the other one takes.
void check_belong_together(const CLI::App& command, const std::vector<CLI::Option*>& of_rays, bool pixel) {
  if (!pixel && command.count("--rays") == 0)
    throw CLI::ValidationError("kairos query", "give rays with --rays or a pixel with --pixel");
  for (const char* name : {"--all", "--occluded", "--window", "--max-dist"})
    if (pixel && command.count(name) > 0) throw CLI::ValidationError(name, "is about rays, and not about a pixel");
  for (const CLI::Option* option : command.get_options())
    if (!pixel && option->count() > 0 && option->get_name() != "--instruction-set" &&
        std::find(of_rays.begin(), of_rays.end(), option) == of_rays.end())
      throw CLI::ValidationError(option->get_name(), "needs a pixel: --pixel X,Y");
}

}  // namespace

void add_query_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("query", "Say what rays see, and from when to when");
  const auto arguments = std::make_shared<QueryArguments>();
  add_scene_arguments(command, arguments->scene);
  auto* rays = command
                   .add_option("--rays", arguments->rays,
                               "One ray a line: ox oy oz dx dy dz, in world space; - reads standard input")
                   ->type_name("FILE|-");
  command
      .add_option_function<std::string>(
          "--pixel", [arguments](const std::string& text) { read_pixel(text, *arguments); },
          "In place of rays: print what render does in this pixel, with the options below")
      ->type_name("X,Y")
      ->excludes(rays);
  auto* all = command.add_flag("--all", arguments->all, "Every triangle met, hidden or not");
  command.add_flag("--occluded", arguments->occluded, "Only when anything is met")->excludes(all);
  const auto add = [&](const char* name, const char* form, void (*read)(const std::string&, TraceLimits&),
                       const char* help) {
    command
        .add_option_function<std::string>(
            name, [arguments, read](const std::string& text) { read(text, arguments->limits); }, help)
        ->type_name(form);
  };
  add("--window", "BEGIN,END", read_window, "Only this part of the shutter, 0 to 1");
  add("--max-dist", "DIST", read_max_dist, "Only up to this distance, in units of the direction's length");
  const std::vector<CLI::Option*> of_rays = command.get_options();
  add_exposure_options(command, arguments->sampling.exposure);
  add_sampling_options(command, arguments->sampling);
  add_light_options(command, arguments->light);
  command.callback([arguments, &chosen, &command, of_rays] {
    check_belong_together(command, of_rays, arguments->pixel.has_value());
    choose_integrator(command, arguments->sampling.params);
    arguments->scene.shot.textures = arguments->pixel && arguments->sampling.params.shading != ShadingKind::normal;
    arguments->scene.shot.strict = arguments->scene.load.strict;
    if (arguments->pixel) arguments->light.apply(command, arguments->sampling.params, arguments->scene.shot);
    chosen = [arguments] { run_query(*arguments); };
  });
}

}  // namespace kairos::cli
