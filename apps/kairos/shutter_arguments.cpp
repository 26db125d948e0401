#include "shutter_arguments.h"

#include <cmath>
#include <utility>
#include <vector>

#include <kairos/error.h>
#include <kairos/image.h>

namespace kairos::cli {

namespace {

[[noreturn]] void refuse(const std::string& option, std::string_view text, const char* form) {
  throw CLI::ValidationError(option, fmt::format("'{}' is not of the form {}", text, form));
}

std::vector<double> numbers(const std::string& option, std::string_view text, size_t count, const char* form) {
  std::vector<double> result;
  for (const std::string_view part : split(option, text, ',', count, form)) result.push_back(parse_real(option, part));
  return result;
}

/// (0, from) to (1, to) of a cubic Bezier curve, whose points' times must ascend.
void add_bezier(const std::array<TimeWeight::Point, 4>& control, std::vector<TimeWeight::Point>& points) {
  constexpr int kSteps = 64;  // off by less than 1e-4
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps, s = 1 - t;
    const std::array<double, 4> share{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    TimeWeight::Point point;
    for (size_t k = 0; k < 4; ++k) {
      point.time += share[k] * control[k].time;
      point.weight += share[k] * control[k].weight;
    }
    points.push_back({std::clamp(point.time, 0.0, 1.0), point.weight});
  }
}

/// `kind` and what comes after its colon.
TimeWeight parse_curve(const std::string& option, const std::string& text) {
  const size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::string_view rest = colon == text.npos ? std::string_view() : std::string_view(text).substr(colon + 1);
  if (kind == "box" && rest.empty()) return {};
  if (kind == "triangle" && rest.empty()) return TimeWeight({{0, 0}, {0.5, 1}, {1, 0}});
  std::vector<TimeWeight::Point> points;
  if (kind == "trapezoid") {
    constexpr const char* kForm = "trapezoid:A,B with 0 <= A <= B <= 1";
    const auto ends = numbers(option, rest, 2, kForm);
    if (!(0 <= ends[0] && ends[0] <= ends[1] && ends[1] <= 1)) refuse(option, text, kForm);
    points = {{0, 0}, {ends[0], 1}, {ends[1], 1}, {1, 0}};
  } else if (kind == "bezier") {
    constexpr const char* kForm = "bezier:A,B,C1,C2,D1,D2,E1,E2,F1,F2 with 0 <= C1 <= D1 <= A <= B <= E1 <= F1 <= 1";
    const auto n = numbers(option, rest, 10, kForm);
    const double a = n[0], b = n[1];
    const std::array<double, 8> times{0, n[2], n[4], a, b, n[6], n[8], 1};
    if (!std::is_sorted(times.begin(), times.end())) refuse(option, text, kForm);
    add_bezier({{{0, 0}, {n[2], n[3]}, {n[4], n[5]}, {a, 1}}}, points);
    add_bezier({{{b, 1}, {n[6], n[7]}, {n[8], n[9]}, {1, 0}}}, points);
  } else if (kind == "points") {
    constexpr const char* kForm = "points:TIME WEIGHT,TIME WEIGHT,... with times from 0 to 1 that do not descend";
    for (std::string_view left = rest;;) {
      const size_t comma = left.find(',');
      const auto pair = split(option, left.substr(0, comma), ' ', 2, kForm);
      points.push_back({parse_real(option, pair[0]), parse_real(option, pair[1])});
      if (comma == left.npos) break;
      left.remove_prefix(comma + 1);
    }
  } else {
    refuse(option, text, "box, triangle, trapezoid:A,B, bezier:... or points:...");
  }
  try {
    return TimeWeight(points);
  } catch (const Error& e) {
    throw CLI::ValidationError(option, fmt::format("'{}': {}", text, e.what()));
  }
}

ExposureArguments::Rolling parse_rolling(const std::string& option, const std::string& text) {
  constexpr const char* kForm = "top|bottom|left|right:TIME[/line][:reset]";
  const size_t colon = text.find(':');
  if (colon == text.npos) refuse(option, text, kForm);
  ExposureArguments::Rolling rolling;
  rolling.scan = parse_choice<Scan>(option, std::string_view(text).substr(0, colon));
  std::string_view time = std::string_view(text).substr(colon + 1);
  rolling.reset = take_suffix(time, ":reset");
  rolling.per_line = take_suffix(time, "/line");
  rolling.time = parse_duration(option, time);
  if (rolling.time.value < 0)
    throw CLI::ValidationError(option, "takes a time that is not negative; scan from the other side");
  return rolling;
}

std::shared_ptr<const IntervalMap> read_map(const std::string& path) {
  const Image image = read_image(path);
  const Channel *open = image.find("open"), *close = image.find("close");
  if (open == nullptr || close == nullptr)
    throw Error(ErrorCode::bad_input, path,
                "has no channels 'open' and 'close': when each pixel is exposed, in seconds from the frame's time");
  if (image.left != 0 || image.top != 0 || image.width != image.frame_width || image.height != image.frame_height)
    throw Error(ErrorCode::bad_input, path, "holds a part of a frame; give a map of all of it");
  auto map = std::make_shared<IntervalMap>();
  map->width = image.width;
  map->height = image.height;
  map->open = open->values;
  map->close = close->values;
  return map;
}

std::string time_text(double seconds) {
  const double size = std::abs(seconds);
  if (size >= 1 || size == 0) return fmt::format("{:.6g} s", seconds);
  if (size >= 1e-3) return fmt::format("{:.6g} ms", seconds * 1e3);
  if (size >= 1e-6) return fmt::format("{:.6g} us", seconds * 1e6);
  return fmt::format("{:.6g} ns", seconds * 1e9);
}

}  // namespace

void add_exposure_options(CLI::App& app, ExposureArguments& out) {
  using Text = const std::string&;
  app.add_option_function<std::string>(
         "--rolling", [&out](Text text) { out.rolling = parse_rolling("--rolling", text); },
         "Lines are exposed one after the other: from which side, and how long it takes to read all of them (or one, "
         "with "
         "/line); with :reset all open together")
      ->type_name("SIDE:TIME[/line][:reset]");
  app.add_option_function<std::string>(
         "--curve",
         [&out](Text text) {
           out.curve = parse_curve("--curve", text);
           out.curve_text = text;
         },
         "How much each instant of an exposure counts: box, triangle, trapezoid:A,B, bezier:..., points:T W,...")
      ->type_name("CURVE");
  app.add_flag("--signed-curve", out.signed_curve, "Let --curve be negative");
  app.add_option_function<std::string>(
         "--anchor",
         [&out](Text text) {
           using Anchor = ExposureArguments::Anchor;
           constexpr std::array<std::pair<const char*, Anchor>, 3> kAnchors{
               {{"first", Anchor::first}, {"middle", Anchor::middle}, {"last", Anchor::last}}};
           for (const auto& [name, anchor] : kAnchors)
             if (text == name) {
               out.anchor = anchor;
               return;
             }
           throw CLI::ValidationError("--anchor", fmt::format("'{}' is not one of: first, middle, last", text));
         },
         "Which line of a rolling shutter has the frame's own interval")
      ->type_name("first|middle|last")
      ->default_str("first");
  app.add_option_function<std::string>(
         "--sensor-lines",
         [&out](Text text) {
           constexpr uint64_t kMost = 1 << 24;
           const size_t comma = text.find(',');
           out.sensor_lines = static_cast<int>(parse_count("--sensor-lines", text.substr(0, comma), 1, kMost));
           if (comma != text.npos)
             out.first_line = static_cast<int>(parse_count("--sensor-lines", text.substr(comma + 1), 0, kMost));
         },
         "The frame shows a part of a sensor of so many lines, and its first one is the sensor's number OFFSET")
      ->type_name("N[,OFFSET]");
  app.add_option("--interval-map", out.map,
                 "EXR with channels open and close: when each pixel is exposed, in seconds from the frame's time")
      ->type_name("MAP.exr");
  add_choice<Normalise>(app, "--normalise", out.normalise,
                        "mean: brightness does not depend on the time of exposure; energy: it does, line by line");
}

Shutter shutter_of(const ExposureArguments& arguments, const std::array<double, 2>& interval, double fps, int width,
                   int height) {
  Shutter shutter;
  shutter.open = interval[0];
  shutter.close = interval[1];
  shutter.curve = arguments.curve;
  shutter.normalise = arguments.normalise;
  if (!arguments.signed_curve && arguments.curve.has_negative())
    throw Error(ErrorCode::bad_usage, "--curve", "is negative somewhere; give --signed-curve where that is meant");
  if (!arguments.map.empty()) {
    if (arguments.rolling)
      throw Error(ErrorCode::bad_usage, "--interval-map",
                  "says when each pixel is exposed, and so does --rolling; give one");
    shutter.map = read_map(arguments.map);
  }
  if (!arguments.rolling) return shutter;
  const ExposureArguments::Rolling& rolling = *arguments.rolling;
  shutter.scan = rolling.scan;
  shutter.first_line = arguments.first_line;
  const bool rows = rolling.scan == Scan::top || rolling.scan == Scan::bottom;
  const int lines = arguments.sensor_lines > 0 ? arguments.sensor_lines : rows ? height : width;
  if (arguments.first_line + (rows ? height : width) > lines)
    throw Error(ErrorCode::bad_usage, "--sensor-lines",
                fmt::format("has {} lines, and the frame's {} begin at number {}", lines, rows ? height : width,
                            arguments.first_line));
  const double line_time = rolling.time.in_seconds(fps) / (rolling.per_line ? 1 : lines);
  shutter.open_line = rolling.reset ? 0 : line_time;
  shutter.close_line = line_time;
  using Anchor = ExposureArguments::Anchor;
  const double anchor =
      arguments.anchor == Anchor::first ? 0 : (lines - 1) / (arguments.anchor == Anchor::last ? 1.0 : 2.0);
  shutter.open -= anchor * shutter.open_line;
  shutter.close -= anchor * shutter.close_line;
  return shutter;
}

ExposedShot exposed_shot(const SceneArguments& scene_arguments, const ExposureArguments& arguments,
                         const Scene& scene) {
  ExposedShot result{shot_options(scene_arguments, scene), std::nullopt};
  if (!arguments.any()) return result;
  ShotOptions& options = result.options;
  const SceneContents held = contents(scene);
  const double fps = options.fps.value_or(held.fps);
  if (!(fps > 0)) return result;  // make_shot says what is wrong
  // As make_shot chooses them.
  const std::array<int, 2> scene_size = held.image_size.value_or(std::array<int, 2>{960, 540});
  const int width = options.width > 0 ? options.width : scene_size[0];
  const int height = options.height > 0 ? options.height : scene_size[1];
  std::array<double, 2> interval{0, 0.5 / fps};
  if (options.shutter)
    interval = {(*options.shutter)[0] / fps, (*options.shutter)[1] / fps};
  else if (held.shutter && !options.frame && !options.fps)
    interval = *held.shutter;
  result.frame_time = options.frame.value_or(0) / fps;
  const Shutter shutter = shutter_of(arguments, interval, fps, width, height);
  const ExposureInterval whole = whole_interval(shutter, width, height);
  options.shutter = {whole.open * fps, whole.close * fps};
  if (whole.open < whole.close) result.shutter = shutter;  // else all see one instant
  return result;
}

std::optional<Exposure> ExposedShot::exposure(const Shot& shot) const {
  if (!shutter) return std::nullopt;
  return Exposure(*shutter, frame_time, shot.projection.width, shot.projection.height, shot.shutter_open,
                  shot.shutter_close);
}

std::string shutter_text(const Shutter& shutter, int width, int height) {
  if (shutter.map) {
    const ExposureInterval whole = whole_interval(shutter, width, height);
    return fmt::format("pixels are exposed by a map, between {} and {}", time_text(whole.open), time_text(whole.close));
  }
  const bool rows = shutter.scan == Scan::top || shutter.scan == Scan::bottom;
  const int last = (rows ? height : width) - 1;
  const ExposureInterval first_line = line_interval(shutter, 0), last_line = line_interval(shutter, last);
  if (shutter.open_line == 0 && shutter.close_line == 0)
    return fmt::format("all lines are exposed from {} to {}", time_text(first_line.open), time_text(first_line.close));
  return fmt::format(
      "lines {} to {} from the {}, {} each{}: the first is exposed from {} to {}, the last from {} to {}",
      shutter.first_line, shutter.first_line + last, to_string(shutter.scan), time_text(shutter.close_line),
      shutter.open_line == 0 ? " (all open together)" : "", time_text(first_line.open), time_text(first_line.close),
      time_text(last_line.open), time_text(last_line.close));
}

}  // namespace kairos::cli
