// How pixels are sampled and shaded: options that several subcommands take.
#pragma once

#include <string>

#include <kairos/render.h>

#include "arguments.h"
#include "shutter_arguments.h"

namespace kairos::cli {

inline constexpr const char* kDefaultCalibration = "default";

/// What people expect of a picture of their own files.
inline RenderParams lit() {
  RenderParams params;
  params.shading = ShadingKind::whitted;
  return params;
}

struct SamplingArguments {
  RenderParams params = lit();
  ExposureArguments exposure;
  std::string calibration = kDefaultCalibration;  ///< or a file
};
void add_sampling_options(CLI::App& app, SamplingArguments& out);
/// Who asks for a number of time-continuous rays alone wants those.
void choose_integrator(const CLI::App& app, RenderParams& params);

/// Puts what the calibration's file says, if there is one, into the parameters. Throws Error for one that does not fit.
void read_calibration_into(SamplingArguments& arguments);

}  // namespace kairos::cli
