#include "time_io/file_layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <kairos/error.h>

#include "time_io/crc32c.h"

namespace kairos {

namespace {

constexpr std::array<uint8_t, 8> kMagic{0x89, 'K', 'T', 'I', 'M', 'E', '\r', '\n'};
constexpr std::array<uint8_t, 4> kChunkMagic{'K', 'C', 'H', 'K'}, kIndexMagic{'K', 'I', 'D', 'X'};
constexpr uint32_t kVersion = 1;
constexpr uint16_t kZstd = 1;
constexpr size_t kHeadChecksum = 40, kChunkChecksum = 4, kIndexChecksum = 8;  // where they stand
constexpr uint64_t kMostRatio = 4096;                                         // of bytes before and after packing

template <class Number>
void put(std::span<uint8_t> out, size_t at, Number value) {
  std::memcpy(out.data() + at, &value, sizeof value);
}

template <class Number>
Number get(std::span<const uint8_t> in, size_t at) {
  Number value;
  std::memcpy(&value, in.data() + at, sizeof value);
  return value;
}

template <size_t kSize>
bool begins_with(std::span<const uint8_t> bytes, const std::array<uint8_t, kSize>& magic) {
  return std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// Of all but the four bytes at `field`.
uint32_t checksum_around(std::span<const uint8_t> bytes, size_t field) {
  return crc32c(bytes.data() + field + 4, bytes.size() - field - 4, crc32c(bytes.data(), field));
}

/// What chunk heads and index entries have in common, at the same places.
void put_head(std::span<uint8_t> out, const ChunkHead& head) {
  put(out, 8, static_cast<uint16_t>(head.plane));
  put(out, 10, kZstd);
  put(out, 12, head.tile);
  put(out, 16, head.slab);
  put(out, 20, head.pieces);
  put(out, 24, head.packed_bytes);
  put(out, 32, head.deviation.integral);
  put(out, 36, head.deviation.rounding);
  put(out, 40, head.deviation.clamped);
  put(out, 44, head.objects);
  put(out, 48, head.depth_pieces);
}

bool parse_shared(std::span<const uint8_t> bytes, const TileGrid& grid, ChunkHead& out) {
  const auto plane = get<uint16_t>(bytes, 8);
  if (plane < static_cast<uint16_t>(TimePlane::colour) || plane > static_cast<uint16_t>(TimePlane::rays)) return false;
  out.plane = static_cast<TimePlane>(plane);
  out.tile = get<uint32_t>(bytes, 12);
  out.slab = get<uint32_t>(bytes, 16);
  out.pieces = get<uint32_t>(bytes, 20);
  out.packed_bytes = get<uint64_t>(bytes, 24);
  out.deviation = {get<float>(bytes, 32), get<float>(bytes, 36), get<uint32_t>(bytes, 40)};
  out.objects = get<uint32_t>(bytes, 44);
  out.depth_pieces = get<uint32_t>(bytes, 48);
  if (!holds_objects(out.plane) && out.plane != TimePlane::rays && (out.objects != 0 || out.depth_pieces != 0))
    return false;
  const uint64_t tiles = out.plane == TimePlane::geometry ? slices_of(kMostGeometryBytes) : grid.count();
  if (get<uint16_t>(bytes, 10) != kZstd || out.tile >= tiles || out.slab >= kMostSlabs) return false;
  const uint64_t raw = raw_tile_bytes(counts_of(out, grid), out.plane);
  return raw <= kMostTileBytes && out.packed_bytes <= 2 * kMostTileBytes &&
         raw <= kMostRatio * out.packed_bytes + kMostRatio && std::isfinite(out.deviation.integral) &&
         std::isfinite(out.deviation.rounding);
}

}  // namespace

std::vector<uint8_t> head_bytes(const FileHead& head, const std::string& text) {
  std::vector<uint8_t> bytes(kFileHeadBytes + text.size());
  std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
  put(std::span(bytes), 8, kVersion);
  put(std::span(bytes), 12, static_cast<uint32_t>(text.size()));
  put(std::span(bytes), 16, head.index_offset);
  put(std::span(bytes), 24, head.file_bytes);
  put(std::span(bytes), 32, static_cast<uint32_t>(kTimeTileSide));
  put(std::span(bytes), 36, head.chunks);
  std::copy(text.begin(), text.end(), bytes.begin() + kFileHeadBytes);
  put(std::span(bytes), kHeadChecksum, checksum_around(bytes, kHeadChecksum));
  return bytes;
}

FileHead parse_head(std::span<const uint8_t, kFileHeadBytes> bytes, const std::string& path) {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::bad_input, path, what); };
  if (!begins_with(bytes, kMagic)) refuse("is no picture over time; give a file of kairos render --time");
  if (const auto version = get<uint32_t>(bytes, 8); version != kVersion)
    refuse("is of version " + std::to_string(version) + ", and this kairos reads version " + std::to_string(kVersion));
  const FileHead head{get<uint32_t>(bytes, 12), get<uint64_t>(bytes, 16), get<uint64_t>(bytes, 24),
                      get<uint32_t>(bytes, 36)};
  if (head.text_bytes > kMostTextBytes || head.text_bytes % kAlignment != 0 ||
      get<uint32_t>(bytes, 32) != kTimeTileSide)
    refuse("has a damaged header; render it again");
  return head;
}

bool head_is_sound(std::span<const uint8_t, kFileHeadBytes> bytes, const std::string& text) {
  std::vector<uint8_t> all(bytes.begin(), bytes.end());
  all.insert(all.end(), text.begin(), text.end());
  return get<uint32_t>(all, kHeadChecksum) == checksum_around(all, kHeadChecksum);
}

namespace {

std::vector<uint8_t> chunk_bytes(const ChunkHead& of, std::span<const uint8_t> packed) {
  std::vector<uint8_t> bytes(aligned(kChunkHeadBytes + packed.size()));
  std::copy(kChunkMagic.begin(), kChunkMagic.end(), bytes.begin());
  put_head(bytes, of);
  std::copy(packed.begin(), packed.end(), bytes.begin() + kChunkHeadBytes);
  const std::span<const uint8_t, kChunkHeadBytes> head = std::span(bytes).first<kChunkHeadBytes>();
  put(std::span(bytes), kChunkChecksum, chunk_checksum(head, packed));
  return bytes;
}

}  // namespace

std::vector<uint8_t> chunk_bytes(const TimeTile& tile, uint32_t slab, uint32_t number,
                                 std::span<const uint8_t> packed) {
  ChunkHead head;
  head.plane = tile.exact() ? TimePlane::exact_colour : TimePlane::colour;
  head.tile = number;
  head.slab = slab;
  head.pieces = static_cast<uint32_t>(tile.pieces());
  head.packed_bytes = packed.size();
  head.deviation = tile.deviation;
  return chunk_bytes(head, packed);
}

std::vector<uint8_t> slice_chunk_bytes(uint64_t bytes, uint32_t number, std::span<const uint8_t> packed) {
  ChunkHead head;
  head.plane = TimePlane::geometry;
  head.tile = number;
  head.pieces = static_cast<uint32_t>(bytes);
  head.packed_bytes = packed.size();
  return chunk_bytes(head, packed);
}

std::vector<uint8_t> chunk_bytes(const ObjectTile& tile, bool exact, uint32_t slab, uint32_t number,
                                 std::span<const uint8_t> packed) {
  ChunkHead head;
  head.plane = exact ? TimePlane::exact_objects : TimePlane::objects;
  head.tile = number;
  head.slab = slab;
  head.pieces = static_cast<uint32_t>(tile.signals.pieces());
  head.objects = static_cast<uint32_t>(tile.mesh.size());
  head.depth_pieces = static_cast<uint32_t>(tile.depth.begin.size());
  head.packed_bytes = packed.size();
  head.deviation = tile.signals.deviation;
  return chunk_bytes(head, packed);
}

std::vector<uint8_t> chunk_bytes(const RecordTile& tile, uint32_t slab, uint32_t number,
                                 std::span<const uint8_t> packed) {
  ChunkHead head;
  head.plane = TimePlane::rays;
  head.tile = number;
  head.slab = slab;
  head.pieces = static_cast<uint32_t>(tile.knots.size());
  head.objects = static_cast<uint32_t>(tile.rays.size() + tile.still_rays.size());
  head.depth_pieces = static_cast<uint32_t>(tile.parts.size());
  head.packed_bytes = packed.size();
  return chunk_bytes(head, packed);
}

bool parse_chunk_head(std::span<const uint8_t, kChunkHeadBytes> bytes, const TileGrid& grid, ChunkHead& out) {
  out.checksum = get<uint32_t>(bytes, kChunkChecksum);
  return begins_with(bytes, kChunkMagic) && parse_shared(bytes, grid, out);
}

uint32_t chunk_checksum(std::span<const uint8_t, kChunkHeadBytes> head, std::span<const uint8_t> packed) {
  return crc32c(packed.data(), packed.size(), checksum_around(head, kChunkChecksum));
}

std::vector<uint8_t> index_bytes(std::span<const IndexEntry> entries) {
  std::vector<uint8_t> bytes(index_size(entries.size()));
  std::copy(kIndexMagic.begin(), kIndexMagic.end(), bytes.begin());
  put(std::span(bytes), 4, static_cast<uint32_t>(entries.size()));
  for (size_t i = 0; i < entries.size(); ++i) {
    const auto entry = std::span(bytes).subspan(kIndexHeadBytes + i * kIndexEntryBytes, kIndexEntryBytes);
    put(entry, 0, entries[i].offset);
    put_head(entry, entries[i].head);
  }
  put(std::span(bytes), kIndexChecksum, checksum_around(bytes, kIndexChecksum));
  return bytes;
}

bool parse_index(std::span<const uint8_t> bytes, uint32_t chunks, uint64_t before, const TileGrid& grid,
                 std::vector<IndexEntry>& out) {
  if (bytes.size() != index_size(chunks) || !begins_with(bytes, kIndexMagic) || get<uint32_t>(bytes, 4) != chunks ||
      get<uint32_t>(bytes, kIndexChecksum) != checksum_around(bytes, kIndexChecksum))
    return false;
  out.resize(chunks);
  for (size_t i = 0; i < chunks; ++i) {
    const auto entry = bytes.subspan(kIndexHeadBytes + i * kIndexEntryBytes, kIndexEntryBytes);
    out[i].offset = get<uint64_t>(entry, 0);
    if (!parse_shared(entry, grid, out[i].head) || out[i].offset > before || before - out[i].offset < kChunkHeadBytes ||
        before - out[i].offset - kChunkHeadBytes < out[i].head.packed_bytes)
      return false;
  }
  return true;
}

}  // namespace kairos
