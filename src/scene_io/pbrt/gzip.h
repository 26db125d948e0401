// Files that may be compressed with gzip.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory_budget.h"

namespace kairos::pbrt {

/// Unpacks gzip. Throws Error(bad_input, path) for what is none, is cut short, or unpacks to more than `limit` bytes.
std::vector<uint8_t> gunzip(std::string_view packed, uint64_t limit, const std::string& path);

/// The whole file, unpacked when its name ends in ".gz": to 64 times its size and a quarter of what the
/// budget grants to all files at most; what text says takes many times its memory. Throws Error(io) or
/// Error(bad_input).
std::vector<uint8_t> read_maybe_packed(const std::string& path, uint64_t limit, MemoryBudget& budget);

bool ends_with(std::string_view text, std::string_view end);

}  // namespace kairos::pbrt
