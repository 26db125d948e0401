#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "time_io/chunk_scan.h"
#include "time_io/file_layout.h"

namespace kairos {

namespace {

constexpr size_t kMostKeptBytes = size_t{4} << 30;  // of tiles, unpacked

/// Tiles of a file, read when they are first needed.
class FileTiles : public TimeTiles {
 public:
  FileTiles(int file, std::string path, TileGrid grid, double tolerance, std::span<const IndexEntry> entries)
      : file_(file), path_(std::move(path)), grid_(grid), entries_(grid.count()), tiles_(grid.count()) {
    quality_.tolerance = tolerance;
    quality_.missing = static_cast<uint64_t>(grid.width) * static_cast<uint64_t>(grid.height);
    for (const IndexEntry& entry : entries) {
      entries_[entry.head.tile] = entry;
      TimeTile counted;  // without the pieces themselves
      counted.deviation = entry.head.deviation;
      add_to(quality_, counted);
      quality_.pieces += entry.head.pieces;
      quality_.missing -= grid.pixel_count(entry.head.tile);
    }
  }
  ~FileTiles() override { close(file_); }
  FileTiles(const FileTiles&) = delete;
  FileTiles& operator=(const FileTiles&) = delete;

  TimeQuality quality() override { return quality_; }

  std::shared_ptr<const TimeTile> tile(size_t number) override {
    if (entries_[number].offset == 0) return nullptr;
    std::unique_ptr<TilePacker> packer;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (tiles_[number] != nullptr) return tiles_[number];
      if (!packers_.empty()) {
        packer = std::move(packers_.back());
        packers_.pop_back();
      }
    }
    if (packer == nullptr) packer = std::make_unique<TilePacker>();
    auto tile = std::make_shared<const TimeTile>(read(number, *packer));
    const std::lock_guard<std::mutex> lock(mutex_);
    packers_.push_back(std::move(packer));
    if (kept_ + tile->memory_bytes() <= kMostKeptBytes && tiles_[number] == nullptr) {
      kept_ += tile->memory_bytes();
      tiles_[number] = tile;
    }
    return tile;
  }

  TimeTile read(size_t number, TilePacker& packer) const {
    const IndexEntry& entry = entries_[number];
    const std::string place = path_ + ", tile " + std::to_string(number);
    std::vector<uint8_t> packed;
    if (!read_chunk(file_, entry, grid_, packed))
      throw Error(ErrorCode::bad_input, place,
                  "is damaged: these are not the bytes that were written; render it again");
    TimeTile tile = packer.unpack(packed, grid_.pixel_count(number), entry.head.pieces, entry.head.plane, place);
    tile.deviation = entry.head.deviation;
    return tile;
  }

 private:
  int file_;
  std::string path_;
  TileGrid grid_;
  std::vector<IndexEntry> entries_;  // [tile]; offset 0: not there
  TimeQuality quality_;
  std::mutex mutex_;  // of what follows
  std::vector<std::shared_ptr<const TimeTile>> tiles_;
  std::vector<std::unique_ptr<TilePacker>> packers_;
  size_t kept_ = 0;  // bytes
};

/// Closes a file that nobody has taken over.
struct Descriptor {
  int file;
  ~Descriptor() {
    if (file >= 0) close(file);
  }
  int release() { return std::exchange(file, -1); }
};

}  // namespace

TimeFile TimeFile::open(const std::string& path) {
  const auto damaged = [&](const char* what) { return Error(ErrorCode::bad_input, path, what); };
  Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat status {};
  if (file.file < 0 || fstat(file.file, &status) != 0)
    throw Error(ErrorCode::io, path, std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw Error(ErrorCode::io, path, "is not a file; give the name of one");
  const auto size = static_cast<uint64_t>(status.st_size);

  std::array<uint8_t, kFileHeadBytes> head_read{};
  if (!read_at(file.file, 0, head_read)) throw damaged("is no picture over time; give a file of kairos render --time");
  const FileHead head = parse_head(head_read, path);
  std::string text(head.text_bytes, ' ');
  std::vector<uint8_t> text_read(head.text_bytes);
  if (!read_at(file.file, kFileHeadBytes, text_read)) throw damaged("is cut off in its header; render it again");
  text.assign(text_read.begin(), text_read.end());
  if (!head_is_sound(head_read, text)) throw damaged("has a damaged header; render it again");
  FileDescription description = parse_description(text, path);
  const TileGrid grid{description.frame.width, description.frame.height};

  TimeFileInfo info;
  info.bytes = size;
  info.tiles = grid.count();
  info.finished = head.finished();
  info.mark = description.mark;
  std::vector<IndexEntry> entries;
  if (head.finished()) {
    if (head.file_bytes != size) throw damaged("is cut off, or has grown; render it again");
    if (head.index_offset > size || size - head.index_offset != index_size(head.chunks))
      throw damaged("has a damaged header; render it again");
    std::vector<uint8_t> index(size - head.index_offset);
    if (!read_at(file.file, head.index_offset, index) ||
        !parse_index(index, head.chunks, head.index_offset, grid, entries))
      throw damaged("has a damaged index; render it again");
  } else {
    entries = scan_chunks(file.file, kFileHeadBytes + text.size(), grid);
  }
  const TimePlane plane = description.tolerance == 0 ? TimePlane::exact_colour : TimePlane::colour;
  std::vector<bool> known(grid.count());
  for (const IndexEntry& entry : entries) {
    if (known[entry.head.tile] || entry.head.plane != plane) throw damaged("has tiles that do not belong together");
    known[entry.head.tile] = true;
  }
  if (head.finished() && entries.size() != grid.count()) throw damaged("lacks tiles; render it again");
  info.tiles_there = entries.size();
  auto tiles = std::make_shared<FileTiles>(file.release(), path, grid, description.tolerance, entries);
  return {info, TimePicture(std::move(description.frame), std::move(tiles)), path};
}

void TimeFile::check() const {
  // Tiles are unpacked and looked at as they are read.
  const TimeFrame& frame = picture_.frame();
  for (int y = 0; y < frame.height; y += kTimeTileSide)
    for (int x = 0; x < frame.width; x += kTimeTileSide) picture_.signal(frame.left + x, frame.top + y);
}

}  // namespace kairos
