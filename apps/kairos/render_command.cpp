// kairos render: scene in, picture out.
#include <memory>

#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/render.h>

#include "arguments.h"
#include "commands.h"
#include "integrators/names.h"
#include "interrupt.h"
#include "output/atomic_file.h"
#include "progress_bar.h"
#include "report.h"
#include "scene/scene.h"

namespace kairos::cli {

namespace {

struct RenderArguments {
  SceneArguments scene;
  RenderParams params;
  WriteOptions write;
  std::string out, stats_file, command_line;
  bool quiet = false;
};

struct Timings {
  double load = 0, shot = 0, write = 0;
};

void log(const RenderArguments& arguments, const std::string& line) {
  if (!arguments.quiet) fmt::print(stderr, "{}\n", line);
}

uint64_t total_rays(const RenderParams& params, const Shot& shot) {
  const Crop crop = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
  const int per_pixel = params.integrator == IntegratorKind::tc ? params.tc_rays : params.spp;
  return static_cast<uint64_t>(crop.x1 - crop.x0) * static_cast<uint64_t>(crop.y1 - crop.y0) *
         static_cast<uint64_t>(per_pixel);
}

Image render_with_progress(const RenderArguments& arguments, const Shot& shot, RenderStats& stats) {
  std::unique_ptr<ProgressBar> bar;
  bool polling = false;
  const auto progress = [&](double fraction) {
    if (!polling) begin_polling();  // rendering has begun: before, a signal ends the program at once
    polling = true;
    if (!bar && !arguments.quiet)
      bar = std::make_unique<ProgressBar>(static_cast<double>(total_rays(arguments.params, shot)));
    if (bar) bar->update(fraction);
    return !interrupted();
  };
  try {
    Image image = render(shot, arguments.params, &stats, progress);
    end_polling();
    if (!interrupted()) return image;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
  }
  throw Error(ErrorCode::cancelled, "", "interrupted");
}

double ratio(uint64_t a, uint64_t b) { return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b); }

std::string stats_text(const RenderArguments& arguments, const Shot& shot, const RenderStats& stats,
                       const Timings& timings) {
  const RenderParams& params = arguments.params;
  const bool tc = params.integrator == IntegratorKind::tc;
  const bool discrete_only = params.integrator == IntegratorKind::qmc;
  nlohmann::ordered_json json;
  json["load_seconds"] = timings.load + timings.shot;
  json["build_seconds"] = stats.build_seconds;
  json["render_seconds"] = stats.render_seconds;
  json["write_seconds"] = timings.write;
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["geometry_memory_bytes"] = mesh_bytes(shot.meshes);
  json["accel_memory_bytes"] = stats.accel_memory_bytes;
  json["triangles"] = triangle_count(shot.meshes);
  json["rays"] = stats.rays;
  json["shading_samples"] = stats.shading_samples;
  json["threads"] = stats.threads;
  json["instruction_set"] = stats.instruction_set ? std::string(to_string(*stats.instruction_set)) : "embree";
  json["integrator"] = name_of(kIntegratorNames, params.integrator);
  json["samples"] = tc ? params.tc_rays : params.spp;
  json["seed"] = params.seed;
  // Embree does not count its work: null, rather than a number that is not known.
  nlohmann::ordered_json& counters = json["counters"];
  const auto counted = [&](uint64_t count) {
    return discrete_only ? nlohmann::ordered_json() : nlohmann::ordered_json(count);
  };
  counters["nodes"] = counted(stats.counters.nodes);
  counters["triangles_tested"] = counted(stats.counters.triangles);
  counters["root_solves"] = counted(stats.counters.root_solves);
  counters["hits"] = counted(stats.counters.hits);
  counters["segments"] = stats.segments;
  counters["segments_per_ray"] = ratio(stats.segments, stats.rays);
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void run_render(RenderArguments arguments) {
  check_writable_image(arguments.out);
  if (!arguments.stats_file.empty()) check_writable(arguments.stats_file);
  Timings timings;

  const Stopwatch loading;
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  timings.load = loading.seconds();
  const Stopwatch reducing;
  const Shot shot = make_shot(*scene, arguments.scene.shot);
  timings.shot = reducing.seconds();
  for (const std::string& warning : scene->warnings) log(arguments, "warning: " + warning);
  log(arguments, fmt::format("loaded {} meshes, {} triangles in {:.2f} s; {}x{} pixels, shutter {} to {}",
                             shot.meshes.size(), triangle_count(shot.meshes), timings.load + timings.shot,
                             shot.projection.width, shot.projection.height, shot.shutter_open, shot.shutter_close));
  for (const std::string& note : shot.notes) log(arguments, "note: " + note);

  RenderStats stats;
  Image image = render_with_progress(arguments, shot, stats);
  log(arguments,
      fmt::format("built in {:.2f} s, rendered {} rays in {:.2f} s ({}rays/s) on {} threads, {}", stats.build_seconds,
                  stats.rays, stats.render_seconds, with_unit(static_cast<double>(stats.rays) / stats.render_seconds),
                  stats.threads,
                  stats.instruction_set ? fmt::format("instruction set {}", to_string(*stats.instruction_set))
                                        : std::string("Embree")));

  image.attributes.push_back({"kairos:command_line", arguments.command_line});
  const Stopwatch writing;
  guard_file(temporary_name(arguments.out));
  write_image(image, arguments.out, arguments.write);
  guard_file("");
  timings.write = writing.seconds();
  if (!arguments.stats_file.empty()) {
    const std::string text = stats_text(arguments, shot, stats, timings);
    AtomicFile file(arguments.stats_file);
    file.write(text.data(), text.size());
    file.commit();
  }
  log(arguments, fmt::format("wrote {}", arguments.out));
}

void add_picture_options(CLI::App& app, RenderArguments& out) {
  RenderParams& params = out.params;
  app.add_option("-o,--output", out.out, "The picture to write")->type_name("OUT.exr|OUT.png")->required();
  app.add_flag("--half", out.write.half, "16-bit colours in EXR (depth stays 32-bit)");
  app.add_option_function<std::string>(
         "--aov",
         [&params](const std::string& text) {
           params.aovs.clear();
           for (std::string_view rest = text;;) {
             const size_t comma = rest.find(',');
             const Aov aov = parse_choice("--aov", rest.substr(0, comma), kAovNames);
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
  add_choice(app, "--filter", params.filter, kFilterNames, "Pixel filter");
}

void add_sampling_options(CLI::App& app, RenderArguments& out) {
  constexpr uint64_t kMostSamples = 1u << 20, kMostShadingSamples = 1u << 16;
  RenderParams& params = out.params;
  add_choice(
      app, "--integrator", params.integrator, kIntegratorNames,
      "tc: time-continuous rays, exact in time; qmc: discrete rays; mixed: tc where anything moves, discrete rays "
      "for what stands still; auto: mixed, rays chosen per pixel for the time of --spp discrete samples");
  add_count(app, "--tc-rays", params.tc_rays, 1, kMostSamples,
            "Rays per pixel of tc, and of mixed where anything moves");
  add_count(app, "--shading-samples", params.shading_samples, 1, kMostShadingSamples,
            "Shading samples per time-continuous ray");
  add_count(app, "--spp", params.spp, 1, kMostSamples,
            "Samples per pixel of qmc; of mixed: discrete rays; of auto: the budget");
  add_choice(app, "--sampler", params.sampler, kSamplerNames, "Where in the pixel, and when, samples are taken");
  add_choice(app, "--shading", params.shading, kShadingNames,
             "normal: |normal| as colour; flat: base colour, unlit; whitted: lit, with shadows, mirrors and glass");
  add_count(app, "--max-depth", params.max_depth, 0, 64, "whitted: how often a ray may be reflected or refracted");
  add_count(app, "--seed", params.seed, 0, UINT64_MAX, "Another seed gives another noise");
  add_instruction_set(app, params.instruction_set);
}

}  // namespace

void add_render_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("render", "Render a scene to a picture");
  const auto arguments = std::make_shared<RenderArguments>();
  arguments->command_line = command_line;
  add_scene_arguments(command, arguments->scene);
  add_picture_options(command, *arguments);
  add_sampling_options(command, *arguments);
  command.add_option("--stats-file", arguments->stats_file, "Write times, memory and counters to this JSON file")
      ->type_name("F.json");
  command.add_flag("--quiet", arguments->quiet, "No log and no progress, errors only");
  command.callback([arguments, &chosen] {
    arguments->params.threads = arguments->scene.threads;
    const std::vector<Aov>& aovs = arguments->params.aovs;
    arguments->scene.shot.textures = arguments->params.shading != ShadingKind::normal ||
                                     std::find(aovs.begin(), aovs.end(), Aov::albedo) != aovs.end();
    arguments->scene.shot.strict = arguments->scene.load.strict;
    chosen = [arguments] { run_render(*arguments); };
  });
}

}  // namespace kairos::cli
