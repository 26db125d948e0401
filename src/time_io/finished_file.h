// A picture over time in its finished form: tiles in order, and an index.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "time_io/file_layout.h"

namespace kairos {

/// Writes `path` whole or not at all. text: of the description. chunks: all of them, in order. read(i, bytes)
/// fills in all of chunks[i], and is called for one after the other. Throws Error(io), and what `read` does.
void write_time_file(const std::string& path, const std::string& text, std::span<const ChunkHead> chunks,
                     const std::function<void(size_t chunk, std::span<uint8_t> bytes)>& read);

}  // namespace kairos
