// The subcommands. Each adds itself to the command line; main runs the one that was chosen.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

namespace kairos::cli {

/// What to do once the command line is known to be right. Throws kairos::Error.
using Action = std::function<void()>;

/// command_line: as typed, for the picture's header or the page.
void add_render_command(CLI::App& app, Action& chosen, const std::string& command_line);
void add_study_command(CLI::App& app, Action& chosen, const std::string& command_line);
void add_calibrate_command(CLI::App& app, Action& chosen);
void add_query_command(CLI::App& app, Action& chosen);
void add_info_command(CLI::App& app, Action& chosen);
void add_compare_command(CLI::App& app, Action& chosen);
void add_expose_command(CLI::App& app, Action& chosen, const std::string& command_line);
void add_flow_command(CLI::App& app, Action& chosen, const std::string& command_line);
void add_dataset_command(CLI::App& app, Action& chosen, const std::string& command_line);
void add_check_command(CLI::App& app, Action& chosen);
void add_convert_command(CLI::App& app, Action& chosen);
void add_merge_command(CLI::App& app, Action& chosen);
void add_jobs_command(CLI::App& app, Action& chosen);
/// Added last: it tells shells of the others.
void add_completion_command(CLI::App& app, Action& chosen);
void add_events_command(CLI::App& app, Action& chosen, const std::string& command_line);

}  // namespace kairos::cli
