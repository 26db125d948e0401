// Pictures over time on the command line of kairos render.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <kairos/scene.h>
#include <kairos/time_picture.h>

namespace kairos::cli {

/// --time, --time-tolerance. path: empty where none is to be written.
void add_time_options(CLI::App& app, std::string& path, double& tolerance);

/// From when a shot's shutter times are counted.
FrameClock clock_of(const ShotOptions& options, const SceneContents& scene);

/// One line: how large a file is, and how exact.
std::string time_file_text(const std::string& path);
std::string quality_text(const TimeQuality& quality);

}  // namespace kairos::cli
