#include "arguments.h"

#include <charconv>
#include <cmath>

namespace kairos::cli {

uint64_t parse_count(const std::string& option, std::string_view text, uint64_t least, uint64_t most) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    throw CLI::ValidationError(option, fmt::format("'{}' is not a whole number from {} to {}", text, least, most));
  return value;
}

double parse_real(const std::string& option, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw CLI::ValidationError(option, fmt::format("'{}' is not a finite number", text));
  return value;
}

std::vector<std::string_view> split(const std::string& option, std::string_view text, char separator, size_t count,
                                    const char* form) {
  std::vector<std::string_view> parts;
  std::string_view rest = text;
  for (size_t at = rest.find(separator); at != std::string_view::npos; at = rest.find(separator)) {
    parts.push_back(rest.substr(0, at));
    rest.remove_prefix(at + 1);
  }
  parts.push_back(rest);
  if (parts.size() != count) throw CLI::ValidationError(option, fmt::format("'{}' is not of the form {}", text, form));
  return parts;
}

bool take_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  return true;
}

Duration parse_duration(const std::string& option, std::string_view text) {
  std::string_view number = text;
  if (const size_t slash = text.find('/'); slash != text.npos) {
    number = text.substr(slash + 1);
    const bool seconds = take_suffix(number, "s");
    const double over = parse_real(option, text.substr(0, slash)), under = parse_real(option, number);
    if (!seconds || !(under > 0))
      throw CLI::ValidationError(option, fmt::format("'{}' is not of the form 1/250s", text));
    return {over / under, true};
  }
  if (take_suffix(number, "deg")) return {parse_real(option, number) / 360, false};
  if (take_suffix(number, "%")) return {parse_real(option, number) / 100, false};
  if (take_suffix(number, "f")) return {parse_real(option, number), false};
  constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
      {{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"s", 1}}};
  for (const auto& [unit, scale] : kUnits)
    if (take_suffix(number, unit)) return {parse_real(option, number) * scale, true};
  return {parse_real(option, number), false};
}

namespace {

ShutterInterval parse_shutter(const std::string& option, std::string_view text) {
  ShutterInterval interval;
  if (text.find(',') != text.npos) {
    const auto parts = split(option, text, ',', 2, "OPEN,CLOSE");
    interval.open = parse_duration(option, parts[0]);
    interval.close = parse_duration(option, parts[1]);
    if (interval.open.seconds == interval.close.seconds && interval.open.value > interval.close.value)
      throw CLI::ValidationError(option, "closes before it opens; give OPEN <= CLOSE");
    return interval;
  }
  const size_t at = text.find('@');
  interval.length = parse_duration(option, text.substr(0, at));
  if (at != text.npos) interval.open = parse_duration(option, text.substr(at + 1));
  if (interval.length->value < 0) throw CLI::ValidationError(option, "has a negative length; give LENGTH@OPEN");
  return interval;
}

}  // namespace

void add_real(CLI::App& app, const std::string& name, const std::string& help, const std::string& type,
              const std::function<void(double)>& set) {
  app.add_option_function<std::string>(
         name, [name, set](const std::string& text) { set(parse_real(name, text)); }, help)
      ->type_name(type);
}

void add_shutter(CLI::App& app, std::optional<ShutterInterval>& out) {
  app.add_option_function<std::string>(
         "--shutter", [&out](const std::string& text) { out = parse_shutter("--shutter", text); },
         "When the shutter opens and closes, or for how long it is open, in frames; or with a unit: f, s, ms, us, ns, "
         "deg, %, or 1/250s")
      ->type_name("OPEN,CLOSE|LENGTH[@OPEN]");
}

CLI::Option* add_scene_only_arguments(CLI::App& app, SceneArguments& out) {
  constexpr double kMostTolerance = 1e6;  // pixels
  constexpr int kMostSide = 65536;        // pixels, as render() has it
  CLI::Option* const scene =
      app.add_option("SCENE", out.paths,
                     "glTF, GLB, OBJ, PLY, pbrt or native JSON; several OBJ or PLY files are motion keys of one mesh");
  app.add_option("--animation", out.load.animation, "Animation to play, 'all' or 'none' (default: the first)")
      ->type_name("NAME|INDEX");
  app.add_option("--gltf-scene", out.load.gltf_scene, "Scene of a glTF file (default: the file's own default)")
      ->type_name("NAME|INDEX");
  app.add_option("--root", out.load.root,
                 "The folder in which everything lies that the scene's files name (default: that of each SCENE)")
      ->type_name("FOLDER");
  app.add_option_function<std::string>(
         "--memory-budget",
         [&](const std::string& text) {
           constexpr uint64_t kMegabyte = 1000000, kMost = 1000000000;
           out.load.memory_budget = parse_count("--memory-budget", text, 1, kMost) * kMegabyte;
         },
         "What a scene may take beside 1024 bytes for each byte of its files, in megabytes [1074]")
      ->type_name("MB");
  app.add_flag("--strict", out.load.strict, "Refuse bad triangles and unsupported features instead of warning");
  app.add_option("--camera", out.shot.camera, "Camera (default: the first, or one that frames everything)")
      ->type_name("NAME|INDEX");
  app.add_option_function<std::string>(
         "--size",
         [&](const std::string& text) {
           const auto parts = split("--size", text, 'x', 2, "WIDTHxHEIGHT");
           out.shot.width = static_cast<int>(parse_count("--size", parts[0], 1, kMostSide));
           out.shot.height = static_cast<int>(parse_count("--size", parts[1], 1, kMostSide));
         },
         out.shot.width > 0 ? fmt::format("Size of the frame in pixels [{}x{}]", out.shot.width, out.shot.height)
                            : "Size of the frame in pixels (default: the scene's own, or 960x540)")
      ->type_name("WxH");
  add_real(app, "--motion-tolerance",
           fmt::format("How far, in pixels, linear motion between keys may leave a vertex's true path [{}]",
                       out.shot.motion_tolerance),
           "PIXELS", [&](double v) {
             if (!(v > 0 && v <= kMostTolerance))
               throw CLI::ValidationError("--motion-tolerance", "must be above 0 and at most 1e6");
             out.shot.motion_tolerance = v;
           });
  add_choice(
      app, "--instances", out.shot.instances,
      "Whether meshes of one shape share it: less memory, rays a little dearer. auto: where copies would be large");
  add_count(app, "--threads", out.threads, 0, 1024, "Threads; 0: as many as the machine has")
      ->each([&out](const std::string&) { out.load.threads = out.shot.threads = out.threads; });
  return scene;
}

void add_scene_arguments(CLI::App& app, SceneArguments& out) {
  add_scene_only_arguments(app, out)->required();
  add_real(app, "--frame", "Frame at which the shutter's times start", "F", [&](double v) { out.shot.frame = v; });
  add_real(app, "--fps", "Frames per second", "R", [&](double v) {
    if (!(v > 0)) throw CLI::ValidationError("--fps", "must be above 0");
    out.shot.fps = v;
  });
  add_shutter(app, out.shutter);
}

ShotOptions shot_options(const SceneArguments& arguments, const Scene& scene) {
  ShotOptions options = arguments.shot;
  if (arguments.shutter) options.shutter = arguments.shutter->in_frames(options.fps.value_or(contents(scene).fps));
  return options;
}

void add_instruction_set(CLI::App& app, std::optional<InstructionSet>& out) {
  app.add_option_function<std::string>(
         "--instruction-set",
         [&out](const std::string& text) {
           out = parse<InstructionSet>(text);
           if (!out)
             throw CLI::ValidationError("--instruction-set",
                                        fmt::format("'{}' is not one of: scalar, sse4, avx2, avx512, neon", text));
         },
         "Kernels and Embree's code to use (default: the best that the machine has)")
      ->type_name("scalar|sse4|avx2|avx512|neon");
}

}  // namespace kairos::cli
