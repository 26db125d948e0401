// The bytes around the tiles of a picture over time: file header, chunk headers, index. docs/time.md, "The file".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <kairos/time_picture.h>

#include "film/time_tiles.h"
#include "time_io/tile_bytes.h"

namespace kairos {

inline constexpr size_t kFileHeadBytes = 64, kChunkHeadBytes = 64, kIndexEntryBytes = 64, kIndexHeadBytes = 16;
inline constexpr uint64_t kAlignment = 16;           // of what a file consists of
inline constexpr uint64_t kMostTextBytes = 1 << 24;  // of the description
inline constexpr uint64_t kSliceBytes = 1 << 26;     // of geometry, before packing; the last one has fewer
inline constexpr uint64_t kMostGeometryBytes = uint64_t{1} << 33;
inline constexpr uint64_t kMostFilePixels = 1u << 28;  // of a picture
inline constexpr uint64_t kMostFileTiles = 1u << 24;   // of all slabs
inline constexpr uint64_t kMostSlabs = 1u << 16;

inline uint64_t aligned(uint64_t size) { return (size + kAlignment - 1) / kAlignment * kAlignment; }

/// What a file begins with. A part has no index.
struct FileHead {
  uint32_t text_bytes = 0;
  uint64_t index_offset = 0;  ///< 0: unfinished
  uint64_t file_bytes = 0;    ///< 0: unfinished
  uint32_t chunks = 0;        ///< 0: unfinished

  bool finished() const { return index_offset != 0; }
};

std::vector<uint8_t> head_bytes(const FileHead& head, const std::string& text);
/// Throws Error(bad_input, path).
FileHead parse_head(std::span<const uint8_t, kFileHeadBytes> bytes, const std::string& path);
/// Does the head's checksum fit it and the description behind it?
bool head_is_sound(std::span<const uint8_t, kFileHeadBytes> bytes, const std::string& text);

/// A tile's place in the file.
struct ChunkHead {
  TimePlane plane = TimePlane::colour;
  uint32_t tile = 0;  ///< or the slice's number
  uint32_t slab = 0;  ///< which part of the time it is of; of geometry, 0
  uint32_t pieces = 0;
  uint32_t objects = 0, depth_pieces = 0;  ///< 0 where the plane holds none; of records, rays and parts
  uint64_t packed_bytes = 0;
  TimeDeviation deviation;
  uint32_t checksum = 0;  ///< of all else in the chunk
};

/// A chunk's head and what is packed, up to where the next chunk may begin.
std::vector<uint8_t> chunk_bytes(const TimeTile& tile, uint32_t slab, uint32_t number, std::span<const uint8_t> packed);
std::vector<uint8_t> slice_chunk_bytes(uint64_t bytes, uint32_t number, std::span<const uint8_t> packed);
std::vector<uint8_t> chunk_bytes(const ObjectTile& tile, bool exact, uint32_t slab, uint32_t number,
                                 std::span<const uint8_t> packed);
std::vector<uint8_t> chunk_bytes(const RecordTile& tile, uint32_t slab, uint32_t number,
                                 std::span<const uint8_t> packed);
/// How much the chunk of a picture with such tiles holds.
inline TileCounts counts_of(const ChunkHead& head, const TileGrid& grid) {
  return {head.plane == TimePlane::geometry ? 0 : grid.pixel_count(head.tile), head.pieces, head.objects,
          head.depth_pieces};
}
/// False for what is no chunk's head, or one of a chunk that could not be in a picture with such tiles.
bool parse_chunk_head(std::span<const uint8_t, kChunkHeadBytes> bytes, const TileGrid& grid, ChunkHead& out);
/// Of the head, without the field itself, and of what is packed.
uint32_t chunk_checksum(std::span<const uint8_t, kChunkHeadBytes> head, std::span<const uint8_t> packed);

/// What there is one of. In order, they are those of a file.
using ChunkKey = std::tuple<TimePlane, uint32_t, uint32_t>;
inline ChunkKey key_of(const ChunkHead& head) { return {head.plane, head.slab, head.tile}; }

struct IndexEntry {
  ChunkHead head;
  uint64_t offset = 0;
};
std::vector<uint8_t> index_bytes(std::span<const IndexEntry> entries);
/// False for what is no index of so many chunks in a file with so many bytes before it.
bool parse_index(std::span<const uint8_t> bytes, uint32_t chunks, uint64_t before, const TileGrid& grid,
                 std::vector<IndexEntry>& out);
inline uint64_t slices_of(uint64_t geometry_bytes) { return (geometry_bytes + kSliceBytes - 1) / kSliceBytes; }
inline uint64_t index_size(uint64_t chunks) { return aligned(kIndexHeadBytes + chunks * kIndexEntryBytes); }

/// JSON: what the picture is of.
struct FileDescription {
  TimeFrame frame;
  uint32_t slabs = 1;           ///< equal parts of the time, which were recorded one after the other
  double tolerance = 0;         ///< in units of a slab's time
  bool objects = false;         ///< does it hold what each mesh contributes?
  bool rays = false;            ///< does it hold records?
  uint64_t meshes = 0;          ///< of the scene, where it holds records
  uint64_t geometry_bytes = 0;  ///< of shot_bytes, in slices; 0: none are held
  std::string mark;
};
/// Those of which every tile has one.
inline std::vector<TimePlane> planes_of(const FileDescription& description) {
  const bool exact = description.tolerance == 0;
  std::vector<TimePlane> planes{exact ? TimePlane::exact_colour : TimePlane::colour};
  if (description.objects) planes.push_back(exact ? TimePlane::exact_objects : TimePlane::objects);
  if (description.rays) planes.push_back(TimePlane::rays);
  return planes;
}
std::string description_text(const FileDescription& description);
/// Throws Error(bad_input, path).
FileDescription parse_description(const std::string& text, const std::string& path);

}  // namespace kairos
