#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <type_traits>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "scene/cut_shot.h"
#include "time_io/chunk_scan.h"
#include "time_io/file_layout.h"
#include "time_io/shot_bytes.h"

namespace kairos {

namespace {

constexpr size_t kMostKeptBytes = size_t{4} << 30;  // of tiles, unpacked

/// Closes a file that nobody has taken over.
struct Descriptor {
  int file;
  ~Descriptor() {
    if (file >= 0) close(file);
  }
  int release() { return std::exchange(file, -1); }
};

}  // namespace

/// Tiles of a file, read when they are first needed.
class TimeFile::Tiles : public TimeTiles {
 public:
  Tiles(int file, std::string path, TileGrid grid, const FileDescription& description,
        std::span<const IndexEntry> entries)
      : file_(file),
        path_(std::move(path)),
        grid_(grid),
        meshes_(description.frame.objects.size()),
        has_objects_(description.objects),
        geometry_bytes_(description.geometry_bytes),
        entries_(grid.count()),
        object_entries_(grid.count()),
        tiles_(grid.count()) {
    quality_.tolerance = description.tolerance;
    quality_.missing = static_cast<uint64_t>(grid.width) * static_cast<uint64_t>(grid.height);
    for (const IndexEntry& entry : entries) {
      if (entry.head.plane == TimePlane::geometry) {
        slices_.resize(std::max<size_t>(slices_.size(), entry.head.tile + 1));
        slices_[entry.head.tile] = entry;
        continue;
      }
      if (holds_objects(entry.head.plane)) {
        object_entries_[entry.head.tile] = entry;
        continue;
      }
      entries_[entry.head.tile] = entry;
      TimeTile counted;  // without the pieces themselves
      counted.deviation = entry.head.deviation;
      add_to(quality_, counted);
      quality_.pieces += entry.head.pieces;
      quality_.missing -= grid.pixel_count(entry.head.tile);
    }
  }
  ~Tiles() override { close(file_); }
  Tiles(const Tiles&) = delete;
  Tiles& operator=(const Tiles&) = delete;

  TimeQuality quality() override { return quality_; }

  std::shared_ptr<const TimeTile> tile(size_t number) override {
    if (entries_[number].offset == 0) return nullptr;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (tiles_[number] != nullptr) return tiles_[number];
    }
    auto tile = std::make_shared<const TimeTile>(with_packer([&](TilePacker& packer) { return read(number, packer); }));
    const std::lock_guard<std::mutex> lock(mutex_);
    if (kept_ + tile->memory_bytes() <= kMostKeptBytes && tiles_[number] == nullptr) {
      kept_ += tile->memory_bytes();
      tiles_[number] = tile;
    }
    return tile;
  }

  bool has_objects() const override { return has_objects_; }
  bool has_geometry() const { return geometry_bytes_ > 0; }

  std::vector<uint8_t> geometry() {
    std::vector<uint8_t> bytes;
    for (const IndexEntry& entry : slices_)
      if (entry.offset != 0) {
        TilePacker packer;
        const auto slice = packer.unpack_slice(packed_bytes(entry), entry.head.pieces, place_of(entry));
        bytes.insert(bytes.end(), slice.begin(), slice.end());
      }
    if (bytes.size() != geometry_bytes_)
      throw Error(ErrorCode::bad_input, path_, "lacks some of its geometry; render it again");
    return bytes;
  }

  /// Read anew each time: few exposures ask for them, and they take much memory.
  std::shared_ptr<const ObjectTile> objects(size_t number) override {
    const IndexEntry& entry = object_entries_[number];
    if (entry.offset == 0) return nullptr;
    return std::make_shared<const ObjectTile>(with_packer([&](TilePacker& packer) {
      return packer.unpack_objects(packed_bytes(entry), counts_of(entry.head, grid_), entry.head.plane, meshes_,
                                   place_of(entry));
    }));
  }

 private:
  TimeTile read(size_t number, TilePacker& packer) const {
    const IndexEntry& entry = entries_[number];
    TimeTile tile = packer.unpack(packed_bytes(entry), counts_of(entry.head, grid_), entry.head.plane, place_of(entry));
    tile.deviation = entry.head.deviation;
    return tile;
  }

  std::string place_of(const IndexEntry& entry) const { return path_ + ", tile " + std::to_string(entry.head.tile); }

  std::vector<uint8_t> packed_bytes(const IndexEntry& entry) const {
    std::vector<uint8_t> packed;
    if (!read_chunk(file_, entry, grid_, packed))
      throw Error(ErrorCode::bad_input, place_of(entry),
                  "is damaged: these are not the bytes that were written; render it again");
    return packed;
  }

  /// use(packer): one that no other thread has.
  template <class Use>
  std::invoke_result_t<const Use&, TilePacker&> with_packer(const Use& use) {
    std::unique_ptr<TilePacker> packer;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!packers_.empty()) {
        packer = std::move(packers_.back());
        packers_.pop_back();
      }
    }
    if (packer == nullptr) packer = std::make_unique<TilePacker>();
    auto used = use(*packer);
    const std::lock_guard<std::mutex> lock(mutex_);
    packers_.push_back(std::move(packer));
    return used;
  }

  int file_;
  std::string path_;
  TileGrid grid_;
  size_t meshes_;
  bool has_objects_;
  uint64_t geometry_bytes_;
  std::vector<IndexEntry> entries_, object_entries_;  // [tile]; offset 0: not there
  std::vector<IndexEntry> slices_;                    // of geometry; the same
  TimeQuality quality_;
  std::mutex mutex_;  // of what follows
  std::vector<std::shared_ptr<const TimeTile>> tiles_;
  std::vector<std::unique_ptr<TilePacker>> packers_;
  size_t kept_ = 0;  // bytes
};

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
  std::set<std::pair<TimePlane, uint32_t>> known;
  for (const IndexEntry& entry : entries)
    if ((entry.head.plane == TimePlane::geometry ? entry.head.tile >= slices_of(description.geometry_bytes)
                                                 : is_exact(entry.head.plane) != (description.tolerance == 0)) ||
        (holds_objects(entry.head.plane) && !description.objects) ||
        !known.insert({entry.head.plane, entry.head.tile}).second)
      throw damaged("has tiles that do not belong together");
  if (head.finished() &&
      entries.size() != grid.count() * planes_of(description).size() + slices_of(description.geometry_bytes))
    throw damaged("lacks tiles; render it again");
  for (uint32_t tile = 0; tile < grid.count(); ++tile) {
    const auto planes = planes_of(description);
    info.tiles_there += std::all_of(planes.begin(), planes.end(), [&](TimePlane plane) {
      return known.contains({plane, tile});
    });
  }
  auto tiles = std::make_shared<Tiles>(file.release(), path, grid, description, entries);
  return {info, TimePicture(std::move(description.frame), tiles), tiles, path};
}

Image TimeFile::expose(const Shutter& shutter, const ExposeOptions& options) const {
  const TimeFrame& frame = picture_.frame();
  return picture_.expose(pixel_weights(Exposure(shutter, frame.frame_time, frame.frame_width, frame.frame_height,
                                                frame.open, frame.close)),
                         options);
}

Image TimeFile::at(double seconds, const ExposeOptions& options) const {
  const TimeFrame& frame = picture_.frame();
  const double time = frame.frame_time + seconds, length = frame.close - frame.open;
  const double shutter_time = length > 0 ? (time - frame.open) / length : time == frame.open ? 0 : -1;
  constexpr double kRounding = 1e-9;  // of sums of times
  if (!(shutter_time >= -kRounding && shutter_time <= 1 + kRounding))
    throw Error(ErrorCode::bad_usage, path_, "does not hold this instant");
  return picture_.at(std::clamp(shutter_time, 0.0, 1.0), options);
}

bool TimeFile::has_geometry() const { return tiles_->has_geometry(); }

Shot TimeFile::shot(double from, double to) const {
  const TimeFrame& frame = picture_.frame();
  if (!has_geometry()) throw Error(ErrorCode::bad_usage, path_, "holds no geometry");
  if (!(frame.open <= from && from < to && to <= frame.close))
    throw Error(ErrorCode::bad_usage, path_, "does not hold these times, or they are not in order");
  const auto time = [&](double scene_time) { return (scene_time - frame.open) / (frame.close - frame.open); };
  Shot cut = cut_shot(parse_shot(tiles_->geometry(), frame.open, frame.close, path_), time(from), time(to));
  cut.shutter_open = from;
  cut.shutter_close = to;
  return cut;
}

void TimeFile::check() const {
  // Tiles are unpacked and looked at as they are read.
  const TimeFrame& frame = picture_.frame();
  for (int y = 0; y < frame.height; y += kTimeTileSide)
    for (int x = 0; x < frame.width; x += kTimeTileSide) picture_.signal(frame.left + x, frame.top + y);
  if (picture_.has_objects()) picture_.objects_at(0);
  if (has_geometry()) parse_shot(tiles_->geometry(), frame.open, frame.close, path_);
}

}  // namespace kairos
