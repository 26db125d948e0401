#include <cerrno>
#include <map>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "base/system_error.h"
#include "time_io/chunk_scan.h"
#include "time_io/file_layout.h"
#include "time_io/finished_file.h"

namespace kairos {

namespace {

/// A part that is open for reading.
class PartFile {
 public:
  explicit PartFile(const std::string& path) : path_(path), file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0) throw_system_error(path, "cannot be read", errno);
  }
  ~PartFile() { close(file_); }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::string& path() const { return path_; }
  int descriptor() const { return file_; }

  /// What it is of, as it stands in the file.
  std::string text() const {
    std::array<uint8_t, kFileHeadBytes> bytes{};
    if (!read_at(file_, 0, bytes)) throw Error(ErrorCode::bad_input, path_, "is no part of a picture over time");
    const FileHead head = parse_head(bytes, path_);
    std::vector<uint8_t> text(head.text_bytes);
    if (head.finished()) throw Error(ErrorCode::bad_input, path_, "is a whole picture over time, not a part of one");
    if (!read_at(file_, kFileHeadBytes, text) || !head_is_sound(bytes, {text.begin(), text.end()}))
      throw Error(ErrorCode::bad_input, path_, "has a damaged header; remove it, and render this part again");
    return {text.begin(), text.end()};
  }

 private:
  std::string path_;
  int file_;
};

}  // namespace

void merge_time_files(const std::vector<std::string>& parts, const std::string& path) {
  struct Place {
    ChunkHead head;
    size_t part = 0;
    uint64_t offset = 0;
  };
  if (parts.empty()) throw Error(ErrorCode::bad_usage, path, "is to be made of no parts");
  const std::string text = PartFile(parts.front()).text();
  const FileDescription description = parse_description(text, parts.front());
  const TimeFrame& frame = description.frame;
  const TileGrid grid{frame.width, frame.height};
  std::map<ChunkKey, Place> places;
  for (size_t part = 0; part < parts.size(); ++part) {
    const PartFile file(parts[part]);
    if (file.text() != text)
      throw Error(ErrorCode::bad_input, parts[part],
                  "is part of another rendering than " + parts.front() +
                      ": scene files, options, kairos or instruction sets were others; remove those that are wrong");
    for (const IndexEntry& entry : scan_chunks(file.descriptor(), kFileHeadBytes + text.size(), grid)) {
      const auto [known, is_new] = places.insert({key_of(entry.head), {entry.head, part, entry.offset}});
      if (!is_new && entry.head.plane != TimePlane::geometry)  // which is in every part
        throw Error(ErrorCode::bad_input, parts[part],
                    "has pixels that " + parts[known->second.part] + " has, too; remove one of them");
    }
  }
  for (const TimePlane plane : planes_of(description))
    for (uint64_t i = 0; i < grid.count() * description.slabs; ++i) {
      const auto slab = static_cast<uint32_t>(i / grid.count()), tile = static_cast<uint32_t>(i % grid.count());
      if (places.contains({plane, slab, tile})) continue;
      const Crop hole = grid.pixels(tile);
      throw Error(ErrorCode::bad_input, path,
                  "no part holds the pixels " + std::to_string(hole.x0) + " to " + std::to_string(hole.x1 - 1) +
                      " of rows " + std::to_string(hole.y0) + " to " + std::to_string(hole.y1 - 1) +
                      ": remove what is damaged or cut off, and render it again");
    }
  std::vector<Place> in_order;
  std::vector<ChunkHead> chunks;
  for (const auto& [key, place] : places) {
    in_order.push_back(place);
    chunks.push_back(place.head);
  }
  std::optional<PartFile> open;  // one at a time, however many there are
  size_t opened = 0;
  write_time_file(path, text, chunks, [&](size_t chunk, std::span<uint8_t> bytes) {
    const Place& place = in_order[chunk];
    if (!open || opened != place.part) open.emplace(parts[opened = place.part]);
    if (!read_at(open->descriptor(), place.offset, bytes))
      throw Error(ErrorCode::io, open->path(), "cannot be read, or has become shorter");
  });
}

}  // namespace kairos
