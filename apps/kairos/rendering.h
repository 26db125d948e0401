// What kairos render does once its arguments are known.
#pragma once

#include <optional>
#include <string>

#include <kairos/image.h>
#include <kairos/time_file.h>

#include "arguments.h"
#include "light_arguments.h"
#include "progress_bar.h"
#include "render_jobs.h"
#include "sampling_arguments.h"
#include "view_arguments.h"

namespace kairos::cli {

struct RenderArguments {
  SceneArguments scene;
  SamplingArguments sampling;
  WriteOptions write;
  TimeFileOptions time_options;  ///< tolerance and planes
  RenderFiles files;
  bool parts_from_input = false;  ///< their numbers, one after the other
  std::string command_line;
  std::optional<double> checkpoint;  ///< seconds
  ViewArguments view;
  LightArguments light;
  const CLI::App* command = nullptr;
  ProgressStyle progress = ProgressStyle::automatic;
  bool quiet = false;
};

/// Throws Error; CLI::ValidationError for parts from standard input that are none.
void run_render(RenderArguments& arguments);

}  // namespace kairos::cli
