// What --stats-file says about a rendered picture.
#pragma once

#include <string>

#include <kairos/render.h>

namespace kairos::cli {

/// Wall clock, seconds.
struct Timings {
  double load = 0, shot = 0, write = 0;
};

/// A JSON object, as text.
std::string stats_text(const RenderParams& params, const Shot& shot, const RenderStats& stats, const Timings& timings);

}  // namespace kairos::cli
