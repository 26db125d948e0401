// Files that are there whole or not at all.
#pragma once

#include <string>
#include <string_view>

#include <kairos/export.h>

namespace kairos {

/// Writes to a temporary file beside `path` that is renamed at the end: nobody sees half a file. Throws Error(io).
KAIROS_API void write_file(const std::string& path, std::string_view bytes);

/// Throws Error(io) when nothing could be written there: to be told before the work is done, not after.
KAIROS_API void check_writable(const std::string& path);

}  // namespace kairos
