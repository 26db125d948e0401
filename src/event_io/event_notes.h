// What a recording is and how it was made, as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <kairos/event_file.h>

namespace kairos {

nlohmann::ordered_json event_notes(const EventOptions& options, const EventStats& stats,
                                   const std::string& command_line);

/// Throws Error(io).
void write_notes(const std::string& path, const nlohmann::ordered_json& notes);

}  // namespace kairos
