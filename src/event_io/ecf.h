// ECF, which packs the events of Metavision's HDF5 files: as prophesee-ai/hdf5_ecf reads and writes it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kairos::ecf {

/// Its number among HDF5's filters.
constexpr int kFilter = 0x8ecf;
/// In one chunk.
constexpr size_t kMostEvents = 65535;

/// As Metavision has it in memory and in HDF5: 16 bytes.
struct CdEvent {
  uint16_t x = 0, y = 0;
  int16_t polarity = 0;  ///< 0 or 1
  int64_t time = 0;      ///< microseconds
};
static_assert(sizeof(CdEvent) == 16);

/// One chunk: 1 to kMostEvents events in the order of time, x and y below 2048.
std::vector<uint8_t> encode(std::span<const CdEvent> events);

/// Throws Error(bad_input, place) for what is no chunk.
std::vector<CdEvent> decode(std::span<const uint8_t> bytes, const std::string& place);

}  // namespace kairos::ecf
