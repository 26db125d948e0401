// What a pixel did: every question about a picture ends here.
#pragma once

#include <array>

#include "arguments.h"
#include "light_arguments.h"
#include "sampling_arguments.h"

namespace kairos::cli {

/// Renders one pixel as `render` would, and prints its record and its colour as JSON on standard output.
void run_pixel_query(const SceneArguments& scene, SamplingArguments sampling, const BackgroundChoice& background,
                     std::array<int, 2> pixel);

}  // namespace kairos::cli
