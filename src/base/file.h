// Reading files that are not to be trusted.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kairos {

/// The whole file. Throws Error(io) when it cannot be read, Error(bad_input) when it is larger than `limit` bytes.
std::vector<uint8_t> read_file(const std::string& path, uint64_t limit);

/// The folder that `path` lies in ("." where it names none).
std::string parent_folder(const std::string& path);

/// `relative` below `folder`. Throws Error(bad_input, place) when it is absolute, holds a NUL or leaves the folder,
/// also by way of a symbolic link. A file that does not exist is not an error here.
std::string resolve_inside(const std::string& folder, std::string_view relative, const std::string& place);

}  // namespace kairos
