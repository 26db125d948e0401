#include "time_io/chunk_scan.h"

#include <cerrno>
#include <set>

#include <sys/stat.h>
#include <unistd.h>

namespace kairos {

bool read_at(int file, uint64_t offset, std::span<uint8_t> out) {
  while (!out.empty()) {
    const ssize_t got = pread(file, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<uint64_t>(got);
    out = out.subspan(static_cast<size_t>(got));
  }
  return true;
}

bool read_chunk(int file, const IndexEntry& entry, const TileGrid& grid, std::vector<uint8_t>& packed) {
  std::array<uint8_t, kChunkHeadBytes> bytes{};
  ChunkHead head;
  if (!read_at(file, entry.offset, bytes) || !parse_chunk_head(bytes, grid, head) || head.tile != entry.head.tile ||
      head.plane != entry.head.plane || head.slab != entry.head.slab ||
      counts_of(head, grid) != counts_of(entry.head, grid) || head.packed_bytes != entry.head.packed_bytes)
    return false;
  packed.resize(head.packed_bytes);
  return read_at(file, entry.offset + kChunkHeadBytes, packed) && chunk_checksum(bytes, packed) == head.checksum;
}

std::vector<IndexEntry> scan_chunks(int file, uint64_t offset, const TileGrid& grid) {
  std::vector<IndexEntry> entries;
  std::set<ChunkKey> known;
  struct stat status {};
  if (fstat(file, &status) != 0) return entries;
  const auto size = static_cast<uint64_t>(status.st_size);
  std::vector<uint8_t> packed;
  for (std::array<uint8_t, kChunkHeadBytes> bytes{}; read_at(file, offset, bytes);) {
    IndexEntry entry;
    entry.offset = offset;
    if (!parse_chunk_head(bytes, grid, entry.head)) break;
    const uint64_t next = offset + aligned(kChunkHeadBytes + entry.head.packed_bytes);
    if (next > size || !read_chunk(file, entry, grid, packed)) break;
    if (known.insert(key_of(entry.head)).second) entries.push_back(entry);
    offset = next;
  }
  return entries;
}

}  // namespace kairos
