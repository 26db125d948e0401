#include "time_io/finished_file.h"

#include <vector>

#include "base/atomic_file.h"

namespace kairos {

void write_time_file(const std::string& path, const std::string& text, std::span<const ChunkHead> chunks,
                     const std::function<void(size_t chunk, std::span<uint8_t> bytes)>& read) {
  uint64_t offset = kFileHeadBytes + text.size();
  std::vector<IndexEntry> index;
  for (const ChunkHead& chunk : chunks) {
    index.push_back({chunk, offset});
    offset += aligned(kChunkHeadBytes + chunk.packed_bytes);
  }
  FileHead head;
  head.index_offset = offset;
  head.file_bytes = offset + index_size(index.size());
  head.chunks = static_cast<uint32_t>(index.size());
  AtomicFile out(path);
  const auto write = [&](const std::vector<uint8_t>& bytes) { out.write(bytes.data(), bytes.size()); };
  write(head_bytes(head, text));
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < chunks.size(); ++i) {
    bytes.resize(aligned(kChunkHeadBytes + chunks[i].packed_bytes));
    read(i, bytes);
    write(bytes);
  }
  write(index_bytes(index));
  out.commit();
}

}  // namespace kairos
