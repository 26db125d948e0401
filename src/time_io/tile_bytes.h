// A tile's signals as bytes, packed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "film/time_tile.h"

namespace kairos {

/// What a chunk holds, and what its header says of it.
enum class TimePlane : uint16_t {
  colour = 1,        ///< 16-bit values
  exact_colour = 2,  ///< 32-bit values
};

/// The most bytes of a tile before packing.
inline constexpr uint64_t kMostTileBytes = uint64_t{1} << 28;

/// Bytes of a tile before packing.
uint64_t raw_tile_bytes(uint64_t pixels, uint64_t pieces, TimePlane plane);

/// Packs and unpacks. One thread's memory, reused from tile to tile.
class TilePacker {
 public:
  TilePacker();
  ~TilePacker();
  TilePacker(const TilePacker&) = delete;
  TilePacker& operator=(const TilePacker&) = delete;

  /// Valid until the next call.
  std::span<const uint8_t> pack(const TimeTile& tile);

  /// A tile of so many pixels and pieces, of which raw_tile_bytes is at most kMostTileBytes. Throws
  /// Error(bad_input, place) for bytes that are no such tile.
  TimeTile unpack(std::span<const uint8_t> packed, uint64_t pixels, uint64_t pieces, TimePlane plane,
                  const std::string& place);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
  std::vector<uint8_t> raw_, packed_;
};

}  // namespace kairos
