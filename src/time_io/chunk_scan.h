// Reading tiles of a file where they lie.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "time_io/file_layout.h"

namespace kairos {

/// Fills `out` with the file's bytes from `offset`, from any thread. False where there are not so many, or the system
/// refuses.
bool read_at(int file, uint64_t offset, std::span<uint8_t> out);

/// The whole chunks from `offset` up to the first that is none or damaged; of several of one tile and plane the first.
std::vector<IndexEntry> scan_chunks(int file, uint64_t offset, const TileGrid& grid);

/// Reads what a chunk has packed. False where it is not what was written.
bool read_chunk(int file, const IndexEntry& entry, const TileGrid& grid, std::vector<uint8_t>& packed);

}  // namespace kairos
