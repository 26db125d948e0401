// Files that say what rays of a shot cost.
#pragma once

#include <string>
#include <string_view>

#include <kairos/render.h>

namespace kairos {

/// As read_calibration; path: for messages.
CalibrationFile parse_calibration(std::string_view text, const std::string& path);

/// The file's text: JSON, from which the same numbers are read.
std::string calibration_text(const CalibrationFile& file);

}  // namespace kairos
