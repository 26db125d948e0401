#include "time_arguments.h"

#include <algorithm>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "arguments.h"
#include "report.h"

namespace kairos::cli {

namespace {

/// "A/B", or a number.
double parse_ratio(const std::string& option, std::string_view text) {
  const size_t slash = text.find('/');
  if (slash == text.npos) return parse_real(option, text);
  return parse_real(option, text.substr(0, slash)) / parse_real(option, text.substr(slash + 1));
}

/// "exact", or ERROR[@LENGTH]: no exposure of that part of the shutter's time or more is off by more.
double parse_tolerance(const std::string& option, const std::string& text) {
  if (text == "exact") return 0;
  const size_t at = text.find('@');
  const double error = parse_ratio(option, std::string_view(text).substr(0, at));
  const double length = at == text.npos ? 0.125 : parse_ratio(option, std::string_view(text).substr(at + 1));
  const double tolerance = error * length / 2;  // a box of that length rises and falls by 1 / length
  if (!(error > 0 && length > 0 && length <= 1 && tolerance >= 0x1p-18 && tolerance <= 1))
    throw CLI::ValidationError(option,
                               fmt::format("'{}' is not 'exact' or ERROR[@LENGTH] with ERROR > 0, 0 < LENGTH <= "
                                           "1 and ERROR x LENGTH of at least 2^-17",
                                           text));
  return tolerance;
}

}  // namespace

bool holds_time(const std::vector<std::string>& paths) {
  return paths.size() == 1 && (paths[0].ends_with(".ktime") || paths[0].ends_with(".ktime.part"));
}

void check_options_of_file(const CLI::App& command, std::set<std::string> known) {
  known.insert({"SCENE", "--fps", "--threads", "--output", "--quiet"});
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && !known.contains(option->get_name()))
      throw CLI::ValidationError(option->get_name(), "is for scenes; a file of time holds what was rendered");
}

void check_recorded(const std::string& path, const TimeFrame& frame, double open, double close) {
  constexpr double kInside = 1e-9;  // parts of the recorded time that rounding may make of what lies inside of it
  const double slack = kInside * (frame.close - frame.open);
  if (open >= frame.open - slack && close <= frame.close + slack) return;
  const double first = (std::min(open, frame.open) - frame.frame_time) * frame.fps;
  const double last = (std::max(close, frame.close) - frame.frame_time) * frame.fps;
  throw Error(
      ErrorCode::bad_input, path,
      fmt::format("holds {:.9g} s to {:.9g} s of the scene's time, and what is asked for begins {:.6g} s before "
                  "and ends {:.6g} s after that; render it again with --shutter {:.9g},{:.9g}",
                  frame.open, frame.close, std::max(0.0, frame.open - open), std::max(0.0, close - frame.close), first,
                  last));
}

std::vector<std::string_view> list_of(std::string_view text) {
  std::vector<std::string_view> items;
  for (size_t comma = text.find(','); comma != text.npos; comma = text.find(',')) {
    items.push_back(text.substr(0, comma));
    text.remove_prefix(comma + 1);
  }
  items.push_back(text);
  return items;
}

void add_time_options(CLI::App& app, std::string& path, TimeFileOptions& out) {
  app.add_option(
         "--time", path,
         "Also write what every pixel shows at every instant of the shutter's time, for kairos expose; what was "
         "begun before is continued")
      ->type_name("OUT.ktime");
  app.add_option_function<std::string>(
         "--time-tolerance",
         [&out](const std::string& text) { out.tolerance = parse_tolerance("--time-tolerance", text); },
         "How far an exposure of LENGTH of the shutter's time, or longer, may be off; or exact")
      ->type_name("ERROR[@LENGTH]|exact")
      ->default_str("1/1024@1/8")
      ->needs("--time");
  app.add_option_function<std::string>(
         "--time-planes",
         [&out](const std::string& text) {
           for (const std::string_view plane : list_of(text)) {
             if (plane != "objects" && plane != "geometry" && plane != "rays")
               throw CLI::ValidationError("--time-planes",
                                          fmt::format("'{}' is not one of: objects, geometry, rays", plane));
             (plane == "objects" ? out.objects : plane == "rays" ? out.rays : out.geometry) = true;
           }
         },
         "What else the file holds: objects, what each mesh contributes to a pixel and how far away it is; geometry, "
         "where everything is, for flow; rays, all that each ray sees, without loss")
      ->type_name("objects,geometry,rays")
      ->needs("--time");
}

FrameClock clock_of(const ShotOptions& options, const SceneContents& scene) {
  const double fps = options.fps.value_or(scene.fps);
  return {options.frame.value_or(0) / fps, fps};
}

std::string quality_text(const TimeQuality& quality) {
  if (quality.exact()) return "exact at every instant";
  std::string text = fmt::format(
      "an exposure of a part L of its time is off by {:.2g} / L + {:.2g} at most, relative to what is brighter than 1",
      2 * quality.deviation, quality.rounding);
  if (quality.clamped > 0) text += fmt::format("; {} values were too large for 16 bits", quality.clamped);
  return text;
}

std::string time_file_text(const std::string& path) {
  const TimeFile file = TimeFile::open(path);
  const TimeFrame& frame = file.picture().frame();
  const TimeQuality quality = file.picture().quality();
  const double pixels = static_cast<double>(frame.width) * frame.height;
  return fmt::format("wrote {}: {}, {:.1f} bytes and {:.1f} pieces a pixel; {}", path, megabytes(file.info().bytes),
                     static_cast<double>(file.info().bytes) / pixels, static_cast<double>(quality.pieces) / pixels,
                     quality_text(quality));
}

}  // namespace kairos::cli
