// Reading and checking what is on the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos::cli {

// Strict: the whole text, decimal, finite. Throw CLI::ValidationError that names the option.
uint64_t parse_count(const std::string& option, std::string_view text, uint64_t least, uint64_t most);
double parse_real(const std::string& option, std::string_view text);
/// Exactly `count` of them, separated by `separator`.
std::vector<std::string_view> split(const std::string& option, std::string_view text, char separator, size_t count,
                                    const char* form);

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

/// The value that `table` has under a name.
template <class Value, size_t N>
Value parse_choice(const std::string& option, std::string_view text,
                   const std::pair<std::string_view, Value> (&table)[N]) {
  std::string known;
  for (const auto& [name, value] : table) {
    if (name == text) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw CLI::ValidationError(option, fmt::format("'{}' is not one of: {}", text, known));
}

/// An option that takes one of the table's names.
template <class Value, size_t N>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& out,
                        const std::pair<std::string_view, Value> (&table)[N], const std::string& help) {
  std::string choices, current;
  for (const auto& [choice, value] : table) {
    choices += (choices.empty() ? "" : "|") + std::string(choice);
    if (value == out) current = choice;
  }
  return app
      .add_option_function<std::string>(
          name, [&out, &table, name](const std::string& text) { out = parse_choice(name, text, table); }, help)
      ->type_name(choices)
      ->default_str(current);
}

/// Which scene, and which stretch of its time: what every subcommand asks.
struct SceneArguments {
  std::vector<std::string> paths;
  LoadOptions load;
  ShotOptions shot;
  int threads = 0;
};
void add_scene_arguments(CLI::App& app, SceneArguments& out);

void add_instruction_set(CLI::App& app, std::optional<InstructionSet>& out);

}  // namespace kairos::cli
