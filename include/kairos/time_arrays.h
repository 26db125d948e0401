// Pictures over time as arrays that programs without Kairos can read.
#pragma once

#include <functional>
#include <string>

#include <kairos/export.h>
#include <kairos/time_picture.h>

namespace kairos {

/// Writes what every pixel shows over time as an archive of numpy arrays (.npz), whole or not at all. docs/time.md,
/// "For numpy", says which they are. progress: as render's. Throws Error(io) when the file cannot be written; what
/// reading a file of time does; Error(cancelled) when `progress` says so.
KAIROS_API void write_time_arrays(const TimePicture& picture, const std::string& path,
                                  const std::function<bool(double fraction)>& progress = {});

}  // namespace kairos
