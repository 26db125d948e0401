// What of a scene is recorded as events, by which sensor, and into which files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kairos/event_file.h>
#include <kairos/event_folder.h>
#include <kairos/events.h>

#include "arguments.h"
#include "light_arguments.h"
#include "parts.h"
#include "progress_bar.h"

namespace kairos::cli {

struct EventsArguments {
  SceneArguments scene;
  LightArguments light;
  EventOptions options;
  std::optional<double> from, to;  ///< unset: as long as the animation
  EventFileOptions file;
  bool has_layout = false;    ///< the first of `outs` is a folder
  EventFolderOptions folder;  ///< of it
  std::vector<std::string> outs;
  std::optional<Part> part;          ///< of the recording that is to be `outs`
  std::optional<double> checkpoint;  ///< seconds
  ProgressStyle progress = ProgressStyle::automatic;
  bool quiet = false;
};

void add_event_sensor_options(CLI::App& app, EventSensor& sensor);
void add_event_file_options(CLI::App& app, EventFileOptions& file);
/// --layout, and what goes with it.
void add_event_folder_options(CLI::App& app, EventsArguments& arguments);

}  // namespace kairos::cli
