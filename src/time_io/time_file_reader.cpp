#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <set>
#include <type_traits>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "film/join_tiles.h"
#include "scene/cut_shot.h"
#include "time_io/chunk_scan.h"
#include "time_io/file_layout.h"
#include "time_io/shot_bytes.h"

namespace kairos {

namespace {

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
        std::span<const IndexEntry> entries, uint64_t most_kept)
      : file_(file),
        path_(std::move(path)),
        grid_(grid),
        meshes_(description.frame.objects.size()),
        meshes_of_rays_(description.meshes),
        has_rays_(description.rays),
        has_objects_(description.objects),
        geometry_bytes_(description.geometry_bytes),
        slabs_(description.slabs),
        exact_(description.tolerance == 0),
        most_kept_(most_kept) {
    std::vector<size_t> there(grid.count());  // [tile]: its slabs
    for (const IndexEntry& entry : entries) {
      entries_.emplace(key_of(entry.head), entry);
      if (entry.head.plane != TimePlane::colour && entry.head.plane != TimePlane::exact_colour) continue;
      TimeTile counted;  // without the pieces themselves
      counted.deviation = entry.head.deviation;
      add_to(quality_, counted);
      quality_.pieces += entry.head.pieces;
      ++there[entry.head.tile];
    }
    for (size_t tile = 0; tile < grid.count(); ++tile)
      if (there[tile] < slabs_) quality_.missing += grid.pixel_count(tile);
    // Of all of the time, in which every slab's integral is that of what was rendered.
    quality_.tolerance = description.tolerance / static_cast<double>(slabs_);
    quality_.deviation /= static_cast<double>(slabs_);
  }
  ~Tiles() override { close(file_); }
  Tiles(const Tiles&) = delete;
  Tiles& operator=(const Tiles&) = delete;

  TimeQuality quality() override { return quality_; }

  std::shared_ptr<const TimeTile> tile(size_t number, const TimeStretch& when) override {
    return of_slabs<TimeTile>(number, when, exact_ ? TimePlane::exact_colour : TimePlane::colour,
                              [&](const IndexEntry& entry) { return signals(entry); });
  }

  bool has_objects() const override { return has_objects_; }
  bool has_geometry() const { return geometry_bytes_ > 0; }
  bool has_rays() const { return has_rays_; }
  size_t slabs() const { return slabs_; }

  /// Of a tile of a slab; none where it was not rendered. Read anew each time.
  RecordTile records(size_t slab, size_t number) {
    const IndexEntry* const entry = find(TimePlane::rays, slab, number);
    if (entry == nullptr) return {};
    return with_packer([&](TilePacker& packer) {
      return packer.unpack_records(packed_bytes(*entry), counts_of(entry->head, grid_), meshes_of_rays_,
                                   place_of(*entry));
    });
  }

  std::vector<uint8_t> geometry() {
    std::vector<uint8_t> bytes;
    for (uint32_t i = 0; i < slices_of(geometry_bytes_); ++i) {
      const IndexEntry* const entry = find(TimePlane::geometry, 0, i);
      if (entry == nullptr) break;
      TilePacker packer;
      const auto slice = packer.unpack_slice(packed_bytes(*entry), entry->head.pieces, place_of(*entry));
      bytes.insert(bytes.end(), slice.begin(), slice.end());
    }
    if (bytes.size() != geometry_bytes_)
      throw Error(ErrorCode::bad_input, path_, "lacks some of its geometry; render it again");
    return bytes;
  }

  /// Read anew each time: few exposures ask for them, and they take much memory.
  std::shared_ptr<const ObjectTile> objects(size_t number, const TimeStretch& when) override {
    const TimePlane plane = exact_ ? TimePlane::exact_objects : TimePlane::objects;
    return of_slabs<ObjectTile>(number, when, plane, [&](const IndexEntry& entry) {
      return std::make_shared<const ObjectTile>(with_packer([&](TilePacker& packer) {
        return packer.unpack_objects(packed_bytes(entry), counts_of(entry.head, grid_), entry.head.plane, meshes_,
                                     place_of(entry));
      }));
    });
  }

 private:
  /// Null where it is not there.
  const IndexEntry* find(TimePlane plane, size_t slab, size_t tile) const {
    const auto found = entries_.find({plane, static_cast<uint32_t>(slab), static_cast<uint32_t>(tile)});
    return found == entries_.end() ? nullptr : &found->second;
  }

  /// read(entry): the tile of a slab. Slabs in which it does not matter are not read.
  template <class Tile, class Read>
  std::shared_ptr<const Tile> of_slabs(size_t number, const TimeStretch& when, TimePlane plane, const Read& read) {
    std::vector<std::shared_ptr<const Tile>> slabs(slabs_);
    bool any = false;
    for (size_t slab = 0; slab < slabs_; ++slab) {
      const IndexEntry* const entry = find(plane, slab, number);
      if (entry == nullptr) continue;
      any = true;
      const auto length = static_cast<double>(slabs_);
      if (slabs_ == 1 ||
          (static_cast<double>(slab) <= when.end * length && static_cast<double>(slab + 1) >= when.begin * length))
        slabs[slab] = read(*entry);
    }
    if (!any || slabs_ == 1) return slabs[0];
    return std::make_shared<const Tile>(join_slabs(slabs, grid_.pixel_count(number)));
  }

  std::shared_ptr<const TimeTile> signals(const IndexEntry& entry) {
    const std::pair key{entry.head.slab, entry.head.tile};
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (const auto kept = tiles_.find(key); kept != tiles_.end()) return kept->second;
    }
    auto tile = std::make_shared<const TimeTile>(with_packer([&](TilePacker& packer) {
      TimeTile read =
          packer.unpack(packed_bytes(entry), counts_of(entry.head, grid_), entry.head.plane, place_of(entry));
      read.deviation = entry.head.deviation;
      return read;
    }));
    const std::lock_guard<std::mutex> lock(mutex_);
    if (kept_ + tile->memory_bytes() <= most_kept_ && tiles_.emplace(key, tile).second) kept_ += tile->memory_bytes();
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
  size_t meshes_, meshes_of_rays_;
  bool has_rays_, has_objects_;
  uint64_t geometry_bytes_;
  size_t slabs_;
  bool exact_;
  std::map<ChunkKey, IndexEntry> entries_;
  TimeQuality quality_;
  std::mutex mutex_;                                                                // of what follows
  std::map<std::pair<uint32_t, uint32_t>, std::shared_ptr<const TimeTile>> tiles_;  // of slab and tile
  std::vector<std::unique_ptr<TilePacker>> packers_;
  uint64_t most_kept_, kept_ = 0;  // bytes
};

TimeFile TimeFile::open(const std::string& path, uint64_t kept_bytes) {
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
  info.slabs = static_cast<int>(description.slabs);
  info.tiles = grid.count() * description.slabs;
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
  std::set<ChunkKey> known;
  for (const IndexEntry& entry : entries)
    if ((entry.head.plane == TimePlane::geometry ? entry.head.tile >= slices_of(description.geometry_bytes)
         : entry.head.plane == TimePlane::rays   ? !description.rays
                                                 : is_exact(entry.head.plane) != (description.tolerance == 0)) ||
        (holds_objects(entry.head.plane) && !description.objects) ||
        entry.head.slab >= (entry.head.plane == TimePlane::geometry ? 1 : description.slabs) ||
        !known.insert(key_of(entry.head)).second)
      throw damaged("has tiles that do not belong together");
  if (head.finished() &&
      entries.size() != info.tiles * planes_of(description).size() + slices_of(description.geometry_bytes))
    throw damaged("lacks tiles; render it again");
  const auto planes = planes_of(description);
  for (const auto& [plane, slab, tile] : known)
    info.tiles_there +=
        plane == planes[0] && std::all_of(planes.begin(), planes.end(), [&, s = slab, t = tile](auto p) {
          return known.contains({p, s, t});
        });
  auto tiles = std::make_shared<Tiles>(file.release(), path, grid, description, entries, kept_bytes);
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

bool TimeFile::has_rays() const { return tiles_->has_rays(); }

void TimeFile::replay(PixelConsumer& consumer, int slab, const std::function<bool(double fraction)>& progress) const {
  if (!has_rays()) throw Error(ErrorCode::bad_usage, path_, "does not hold what rays see");
  if (slab < 0 || static_cast<size_t>(slab) >= tiles_->slabs())
    throw Error(ErrorCode::bad_usage, path_, "has no such slab of time");
  if (consumer.needs().surfaces())
    throw Error(ErrorCode::bad_usage, path_, "holds colours of what rays see, and neither normals nor albedo");
  const TimeFrame& frame = picture_.frame();
  const TileGrid grid{frame.width, frame.height};
  for (size_t number = 0; number < grid.count(); ++number) {
    if (progress && !progress(static_cast<double>(number) / static_cast<double>(grid.count())))
      throw Error(ErrorCode::cancelled, "", "replaying was stopped");
    const RecordTile tile = tiles_->records(static_cast<size_t>(slab), number);
    const Crop crop = grid.pixels(number);
    const int across = crop.x1 - crop.x0;
    for (size_t pixel = 0; pixel < tile.pixels(); ++pixel) {
      const int x = frame.left + crop.x0 + static_cast<int>(pixel) % across,
                y = frame.top + crop.y0 + static_cast<int>(pixel) / across;
      if (!consumer.has(x, y)) consumer.add(tile.record(pixel, x, y));
    }
  }
}

void TimeFile::check() const {
  // Tiles are unpacked and looked at as they are read.
  const TimeFrame& frame = picture_.frame();
  for (size_t number = 0; number < TileGrid{frame.width, frame.height}.count(); ++number) {
    tiles_->tile(number, {});
    if (picture_.has_objects()) tiles_->objects(number, {});
    for (size_t slab = 0; has_rays() && slab < tiles_->slabs(); ++slab) tiles_->records(slab, number);
  }
  if (has_geometry()) parse_shot(tiles_->geometry(), frame.open, frame.close, path_);
}

}  // namespace kairos
