// A tile's signals as bytes, packed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "film/object_tile.h"
#include "film/record_tile.h"
#include "film/time_tile.h"

namespace kairos {

/// What a chunk holds, and what its header says of it.
enum class TimePlane : uint16_t {
  colour = 1,        ///< 16-bit values
  exact_colour = 2,  ///< 32-bit values
  // What each mesh contributes, and how far away it is:
  objects = 3,        ///< 16-bit values
  exact_objects = 4,  ///< 32-bit values
  geometry = 5,       ///< of no tile: a slice of shot_bytes
  rays = 6,           ///< records, without loss
};
inline bool holds_objects(TimePlane plane) { return plane == TimePlane::objects || plane == TimePlane::exact_objects; }
inline bool is_exact(TimePlane plane) { return plane == TimePlane::exact_colour || plane == TimePlane::exact_objects; }

/// How much there is in a chunk.
struct TileCounts {
  uint64_t pixels = 0, pieces = 0;         ///< pieces: of geometry, bytes
  uint64_t objects = 0, depth_pieces = 0;  ///< 0 where it holds none
  // Of records: knots, rays and parts.

  friend bool operator==(const TileCounts&, const TileCounts&) = default;
};

/// The most bytes of a tile before packing.
inline constexpr uint64_t kMostTileBytes = uint64_t{1} << 28;

/// Bytes of a tile before packing.
uint64_t raw_tile_bytes(const TileCounts& counts, TimePlane plane);

/// Packs and unpacks. One thread's memory, reused from tile to tile.
class TilePacker {
 public:
  TilePacker();
  ~TilePacker();
  TilePacker(const TilePacker&) = delete;
  TilePacker& operator=(const TilePacker&) = delete;

  /// Valid until the next call.
  std::span<const uint8_t> pack(const TimeTile& tile);
  std::span<const uint8_t> pack(const ObjectTile& tile);
  std::span<const uint8_t> pack(const RecordTile& tile);
  std::span<const uint8_t> pack(std::span<const uint8_t> slice);

  /// A tile that holds so much, of which raw_tile_bytes is at most kMostTileBytes. Throw Error(bad_input, place) for
  /// bytes that are no such tile.
  TimeTile unpack(std::span<const uint8_t> packed, const TileCounts& counts, TimePlane plane, const std::string& place);
  /// meshes: how many there are in the scene.
  ObjectTile unpack_objects(std::span<const uint8_t> packed, const TileCounts& counts, TimePlane plane, size_t meshes,
                            const std::string& place);
  RecordTile unpack_records(std::span<const uint8_t> packed, const TileCounts& counts, size_t meshes,
                            const std::string& place);
  /// Valid until the next call.
  std::span<const uint8_t> unpack_slice(std::span<const uint8_t> packed, uint64_t size, const std::string& place);

 private:
  struct Contexts;
  std::span<const uint8_t> pack_raw();
  void unpack_raw(std::span<const uint8_t> packed, uint64_t size, const std::string& place);
  std::unique_ptr<Contexts> contexts_;
  std::vector<uint8_t> raw_, packed_;
};

}  // namespace kairos
