// Reading and checking what is on the command line.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/names.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos::cli {

// Strict: the whole text, decimal, finite. Throw CLI::ValidationError that names the option.
uint64_t parse_count(const std::string& option, std::string_view text, uint64_t least, uint64_t most);
double parse_real(const std::string& option, std::string_view text);

/// Exactly `count` of them, separated by `separator`.
std::vector<std::string_view> split(const std::string& option, std::string_view text, char separator, size_t count,
                                    const char* form);

/// `text` without the suffix that it ends with; false where it does not.
bool take_suffix(std::string_view& text, std::string_view suffix);

/// An option that takes a whole number in [least, most].
template <class Number>
CLI::Option* add_count(CLI::App& app, const std::string& name, Number& out, uint64_t least, uint64_t most,
                       const std::string& help) {
  return app
      .add_option_function<std::string>(
          name,
          [&out, name, least, most](const std::string& text) {
            out = static_cast<Number>(parse_count(name, text, least, most));
          },
          help)
      ->type_name("N")
      ->default_str(std::to_string(out));
}

/// An option that takes a finite number.
void add_real(CLI::App& app, const std::string& name, const std::string& help, const std::string& type,
              const std::function<void(double)>& set);

/// What shows surfaces: other shadings neither take time that could be measured nor have a reference.
inline constexpr std::span<const Named<ShadingKind>> kSurfaceShadings = std::span(kNames<ShadingKind>).first(4);

/// The value with that name, of an enum or of those of its values that are offered.
template <class Enum>
Enum parse_choice(const std::string& option, std::string_view text,
                  std::span<const Named<Enum>> offered = kNames<Enum>) {
  std::string known;
  for (const auto& [name, value] : offered) {
    if (name == text) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw CLI::ValidationError(option, fmt::format("'{}' is not one of: {}", text, known));
}

/// An option that takes one of an enum's names.
template <class Enum>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Enum& out, const std::string& help,
                        std::span<const Named<Enum>> offered = kNames<Enum>) {
  std::string choices;
  for (const auto& choice : offered) choices += (choices.empty() ? "" : "|") + std::string(choice.first);
  return app
      .add_option_function<std::string>(
          name, [&out, offered, name](const std::string& text) { out = parse_choice<Enum>(name, text, offered); }, help)
      ->type_name(choices)
      ->default_str(std::string(to_string(out)));
}

/// A time, or a length of time, in frames or in seconds.
struct Duration {
  double value = 0;
  bool seconds = false;

  double in_seconds(double fps) const { return seconds ? value : value / fps; }
  double in_frames(double fps) const { return seconds ? value * fps : value; }
};
/// A number with one of the units f (frames), s, ms, us, ns, deg (360 are a frame) and % (of a frame), or A/Bs; without
/// a unit: frames.
Duration parse_duration(const std::string& option, std::string_view text);

/// What OPEN,CLOSE or LENGTH or LENGTH@OPEN say, from the frame's time.
struct ShutterInterval {
  Duration open, close;            ///< close: where there is no length
  std::optional<Duration> length;  ///< of the exposure

  bool in_seconds() const { return open.seconds || (length ? length->seconds : close.seconds); }
  std::array<double, 2> in_frames(double fps) const {
    const double first = open.in_frames(fps);
    return {first, length ? first + length->in_frames(fps) : close.in_frames(fps)};
  }
};

/// --shutter.
void add_shutter(CLI::App& app, std::optional<ShutterInterval>& out);

/// Which scene, and which stretch of its time: what every subcommand asks.
struct SceneArguments {
  std::vector<std::string> paths;
  LoadOptions load;
  ShotOptions shot;                        ///< without `shutter`
  std::optional<ShutterInterval> shutter;  ///< --shutter
  int threads = 0;
};
void add_scene_arguments(CLI::App& app, SceneArguments& out);
/// All of them but frames and shutters, with what `out` holds as defaults. Returns SCENE, which is not required yet.
CLI::Option* add_scene_only_arguments(CLI::App& app, SceneArguments& out);
/// With times in the scene's own frames.
ShotOptions shot_options(const SceneArguments& arguments, const Scene& scene);

void add_instruction_set(CLI::App& app, std::optional<InstructionSet>& out);

}  // namespace kairos::cli
