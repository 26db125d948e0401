// Pictures over time on the command line of kairos render.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include <kairos/scene.h>
#include <kairos/time_file.h>

namespace kairos::cli {

/// --time, --time-tolerance, --time-planes. path: empty where none is to be written; out: tolerance and planes alone.
void add_time_options(CLI::App& app, std::string& path, TimeFileOptions& out);

/// Are these the name of a file of kairos render --time?
bool holds_time(const std::vector<std::string>& paths);

/// What was rendered is not chosen again: throws CLI::ValidationError for an option of a command on such a file that is
/// neither among `known` nor one of all of them.
void check_options_of_file(const CLI::App& command, std::set<std::string> known);

/// Throws Error(bad_input) where [open, close], scene time, leaves what a file holds: by how much, and what would cover
/// it.
void check_recorded(const std::string& path, const TimeFrame& frame, double open, double close);

/// The items of a list with commas.
std::vector<std::string_view> list_of(std::string_view text);

/// From when a shot's shutter times are counted.
FrameClock clock_of(const ShotOptions& options, const SceneContents& scene);

/// One line: how large a file is, and how exact.
std::string time_file_text(const std::string& path);
std::string quality_text(const TimeQuality& quality);

}  // namespace kairos::cli
