#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/time_file.h>

#include "base/system_error.h"
#include "time_io/chunk_scan.h"
#include "time_io/file_layout.h"
#include "time_io/finished_file.h"
#include "time_io/shot_bytes.h"

namespace kairos {

namespace {

[[noreturn]] void fail(const std::string& path, const char* what) { throw_system_error(path, what, errno); }

/// A file that grows by whole pieces, and that one program at a time writes.
class GrowingFile {
 public:
  explicit GrowingFile(const std::string& path) : path_(path) {
    file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail(path, "cannot be written");
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      close(file_);
      throw Error(ErrorCode::io, path, "is being written by another program; wait for it, or give another name");
    }
  }
  ~GrowingFile() { close(file_); }
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  int descriptor() const { return file_; }
  /// Cuts off what lies behind `size` bytes, and goes on there.
  void go_on_at(uint64_t size) {
    if (ftruncate(file_, static_cast<off_t>(size)) != 0) fail(path_, "cannot be written");
    size_ = size;
  }
  void flush() const {
    if (fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(path_, "cannot be written");
  }
  /// Returns where it lies.
  uint64_t append(std::span<const uint8_t> bytes) {
    const uint64_t at = size_;
    while (!bytes.empty()) {
      const ssize_t written = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail(path_, "cannot be written");
      size_ += static_cast<uint64_t>(written);
      bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return at;
  }

 private:
  std::string path_;
  int file_ = -1;
  uint64_t size_ = 0;
};

}  // namespace

class TimeFileWriter::File {
 public:
  File(const std::string& path, FileDescription description, TileGrid grid, std::span<const uint8_t> geometry)
      : path_(path),
        part_path_(path + ".part"),
        text_(description_text(description)),
        grid_(grid),
        description_(std::move(description)),
        part_((check_writable(path), part_path_)) {
    there_.resize(tiles());
    begin_slab(0);
    begin();
    add_slices(geometry);
    before_ = static_cast<size_t>(std::count(there_.begin(), there_.end(), true));
  }

  size_t tiles() const { return grid_.count() * description_.slabs; }
  size_t tiles_before() const { return before_; }
  bool has(int x, int y) const {
    return there_[place(slab_, grid_.tile_of(x - description_.frame.left, y - description_.frame.top))];
  }

  void begin_slab(uint32_t slab) {
    slab_ = slab;
    maker_.emplace(grid_, description_.frame.left, description_.frame.top, description_.tolerance, description_.objects,
                   description_.rays);
  }
  bool slab_is_there(uint32_t slab) const {
    const auto first = there_.begin() + static_cast<std::ptrdiff_t>(place(slab, 0));
    return std::all_of(first, first + static_cast<std::ptrdiff_t>(grid_.count()), [](bool there) { return there; });
  }

  void add(const PixelRecord& record) {
    if (has(record.x, record.y)) return;
    size_t number = 0;
    const auto tile = maker_->add(record, number);
    if (!tile) return;
    std::unique_ptr<TilePacker> packer = take_packer();
    const auto tile_number = static_cast<uint32_t>(number);
    std::vector<std::vector<uint8_t>> chunks{
        chunk_bytes(tile->signals, slab_, tile_number, packer->pack(tile->signals))};
    if (description_.objects)
      chunks.push_back(
          chunk_bytes(tile->objects, description_.tolerance == 0, slab_, tile_number, packer->pack(tile->objects)));
    if (description_.rays) {
      const RecordTile& records = tile->records;
      if (raw_tile_bytes({records.pixels(), records.knots.size(), records.rays.size() + records.still_rays.size(),
                          records.parts.size()},
                         TimePlane::rays) > kMostTileBytes)
        throw Error(
            ErrorCode::bad_usage, path_,
            "cannot hold so many rays: what those of 32 x 32 pixels see takes more than 256 MiB; take fewer, or "
            "leave rays out of --time-planes");
      chunks.push_back(chunk_bytes(records, slab_, tile_number, packer->pack(records)));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const std::vector<uint8_t>& bytes : chunks) append_chunk(bytes);
    packers_.push_back(std::move(packer));
  }

  /// Copies the tiles in order into the file itself.
  void finish() {
    if (entries_.size() != tiles() * planes() + slices_)
      throw Error(ErrorCode::bad_usage, part_path_, "is not finished: pixels of the picture were not rendered");
    std::vector<ChunkHead> chunks;
    std::vector<uint64_t> offsets;
    for (const auto& [key, entry] : entries_) {
      chunks.push_back(entry.head);
      offsets.push_back(entry.offset);
    }
    write_time_file(path_, text_, chunks, [&](size_t chunk, std::span<uint8_t> bytes) {
      if (!read_at(part_.descriptor(), offsets[chunk], bytes)) fail(part_path_, "cannot be read");
    });
    std::error_code ec;
    std::filesystem::remove(part_path_, ec);
  }

  void finish_part() {
    part_.flush();
    std::error_code ec;
    std::filesystem::rename(part_path_, path_, ec);
    if (ec) throw Error(ErrorCode::io, path_, "cannot be written: " + ec.message());
  }

 private:
  /// Begins the part, or finds what is there of it.
  void begin() {
    const std::vector<uint8_t> head = head_bytes({}, text_);
    std::vector<uint8_t> there(head.size());
    if (!read_at(part_.descriptor(), 0, std::span(there).first(kFileHeadBytes))) {  // empty, or hardly begun
      part_.go_on_at(0);
      part_.append(head);
      return;
    }
    if (!read_at(part_.descriptor(), 0, there) || there != head)
      throw Error(ErrorCode::bad_input, part_path_,
                  "is there, but of another rendering: scene files, options or kairos were others; remove it, or give "
                  "another name");
    uint64_t end = head.size();
    for (const IndexEntry& entry : scan_chunks(part_.descriptor(), head.size(), grid_)) {
      add_entry(entry);
      end = entry.offset + aligned(kChunkHeadBytes + entry.head.packed_bytes);
    }
    part_.go_on_at(end);
    std::vector<size_t> planes_there(tiles());
    for (const auto& [key, entry] : entries_)
      if (entry.head.plane != TimePlane::geometry) ++planes_there[place(entry.head.slab, entry.head.tile)];
    for (size_t tile = 0; tile < tiles(); ++tile) there_[tile] = planes_there[tile] == planes();
  }

  void append_chunk(const std::vector<uint8_t>& bytes) {
    IndexEntry entry;
    parse_chunk_head(std::span(bytes).first<kChunkHeadBytes>(), grid_, entry.head);
    entry.offset = part_.append(bytes);
    add_entry(entry);
  }
  /// Those that are not there yet.
  void add_slices(std::span<const uint8_t> geometry) {
    slices_ = slices_of(geometry.size());
    TilePacker packer;
    for (uint32_t i = 0; i < slices_; ++i) {
      if (entries_.contains({TimePlane::geometry, 0, i})) continue;
      const auto slice = geometry.subspan(i * kSliceBytes, std::min(kSliceBytes, geometry.size() - i * kSliceBytes));
      append_chunk(slice_chunk_bytes(slice.size(), i, packer.pack(slice)));
    }
  }

  size_t planes() const { return planes_of(description_).size(); }
  size_t place(uint32_t slab, size_t tile) const { return slab * grid_.count() + tile; }
  /// Of a tile of which some planes are there, and which is made once more, the first ones stay.
  void add_entry(const IndexEntry& entry) { entries_.emplace(key_of(entry.head), entry); }

  std::unique_ptr<TilePacker> take_packer() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (packers_.empty()) return std::make_unique<TilePacker>();
    auto packer = std::move(packers_.back());
    packers_.pop_back();
    return packer;
  }

  std::string path_, part_path_, text_;
  TileGrid grid_;
  FileDescription description_;
  GrowingFile part_;
  uint32_t slab_ = 0;               // whose records come
  std::optional<TileMaker> maker_;  // of its tiles
  std::vector<bool> there_;         // [slab][tile]: from before
  size_t before_ = 0, slices_ = 0;
  std::mutex mutex_;                        // of what follows, and of the part
  std::map<ChunkKey, IndexEntry> entries_;  // of tiles in the part
  std::vector<std::unique_ptr<TilePacker>> packers_;
};

static_assert(TimeFileWriter::kTileSide == kTimeTileSide);

TimeFileWriter::TimeFileWriter(const std::string& path, const Shot& shot, const RenderParams& params,
                               const TimeFileOptions& options)
    : needs_(time_needs(params)) {
  check_tolerance(options.tolerance);
  TimeFrame frame = time_frame(shot, params, options.clock, options.objects);
  const TileGrid grid{frame.width, frame.height};
  if (options.slabs < 1 || static_cast<uint64_t>(options.slabs) > std::min(kMostSlabs, kMostFileTiles / grid.count()))
    throw Error(ErrorCode::bad_usage, path,
                "cannot hold so many slabs of time: at most " +
                    std::to_string(std::min(kMostSlabs, kMostFileTiles / grid.count())));
  const std::vector<uint8_t> geometry = options.geometry ? shot_bytes(shot) : std::vector<uint8_t>();
  if (geometry.size() > kMostGeometryBytes)
    throw Error(ErrorCode::bad_usage, path,
                "would hold more than 8 GiB of geometry; leave it out of --time-planes, and take kairos flow SCENE");
  file_ = std::make_unique<File>(
      path,
      FileDescription{std::move(frame), static_cast<uint32_t>(options.slabs), options.tolerance, options.objects,
                      options.rays, options.rays ? shot.meshes.size() : 0, geometry.size(), options.mark},
      grid, geometry);
}
TimeFileWriter::~TimeFileWriter() = default;

RecordNeeds TimeFileWriter::needs() const { return needs_; }
bool TimeFileWriter::has(int x, int y) const { return file_->has(x, y); }
void TimeFileWriter::add(const PixelRecord& record) { file_->add(record); }
void TimeFileWriter::begin_slab(int slab) { file_->begin_slab(static_cast<uint32_t>(slab)); }
bool TimeFileWriter::slab_is_there(int slab) const { return file_->slab_is_there(static_cast<uint32_t>(slab)); }
size_t TimeFileWriter::tiles() const { return file_->tiles(); }
size_t TimeFileWriter::tiles_before() const { return file_->tiles_before(); }
void TimeFileWriter::finish() { file_->finish(); }
void TimeFileWriter::finish_part() { file_->finish_part(); }

}  // namespace kairos
