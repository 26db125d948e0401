#include "time_arguments.h"

#include <fmt/format.h>

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

void add_time_options(CLI::App& app, std::string& path, double& tolerance) {
  app.add_option(
         "--time", path,
         "Also write what every pixel shows at every instant of the shutter's time, for kairos expose; what was "
         "begun before is continued")
      ->type_name("OUT.ktime");
  app.add_option_function<std::string>(
         "--time-tolerance",
         [&tolerance](const std::string& text) { tolerance = parse_tolerance("--time-tolerance", text); },
         "How far an exposure of LENGTH of the shutter's time, or longer, may be off; or exact")
      ->type_name("ERROR[@LENGTH]|exact")
      ->default_str("1/1024@1/8")
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
