// Files that say what rays of a shot cost.
#pragma once

#include <string>
#include <string_view>

#include <kairos/render.h>

namespace kairos {

/// A calibration, and what it was measured with.
struct CalibrationFile {
  Calibration calibration;
  std::string shading;  ///< as the command line names it
};

/// Throws Error(io) when the file cannot be read, Error(bad_input) when it is none or holds numbers that make no sense.
CalibrationFile read_calibration(const std::string& path);
/// path: for messages.
CalibrationFile parse_calibration(std::string_view text, const std::string& path);

/// The file's text: JSON, from which the same numbers are read.
std::string calibration_text(const CalibrationFile& file);

}  // namespace kairos
