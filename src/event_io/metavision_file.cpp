// HDF5 files as Prophesee's Metavision writes and reads them: events in chunks of ECF, and an index of every 2 ms.
#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "event_io/ecf.h"
#include "event_io/event_format.h"
#include "event_io/hdf5_numbers.h"
#include "event_io/hdf5_readers.h"

namespace kairos {

namespace {

using ecf::CdEvent;

constexpr hsize_t kCdChunk = 16384;     // elements
constexpr int64_t kIndexPeriod = 2000;  // microseconds

/// The first event of a period: how many come before it, and when it is, counted from the first event of all.
struct Index {
  uint64_t id = 0;
  int64_t time = 0;
};
struct Trigger {
  int16_t polarity = 0;
  int64_t time = 0;
  int16_t id = 0;
};

Hdf5Handle compound(size_t size, const std::string& path) { return {H5Tcreate(H5T_COMPOUND, size), H5Tclose, path}; }
Hdf5Handle event_type(const std::string& path) {
  Hdf5Handle type = compound(sizeof(CdEvent), path);
  H5Tinsert(type, "x", offsetof(CdEvent, x), H5T_NATIVE_USHORT);
  H5Tinsert(type, "y", offsetof(CdEvent, y), H5T_NATIVE_USHORT);
  H5Tinsert(type, "p", offsetof(CdEvent, polarity), H5T_NATIVE_SHORT);
  H5Tinsert(type, "t", offsetof(CdEvent, time), H5T_NATIVE_LLONG);
  return type;
}
Hdf5Handle index_type(const std::string& path) {
  Hdf5Handle type = compound(sizeof(Index), path);
  H5Tinsert(type, "id", offsetof(Index, id), H5T_NATIVE_ULLONG);
  H5Tinsert(type, "ts", offsetof(Index, time), H5T_NATIVE_LLONG);
  return type;
}
Hdf5Handle trigger_type(const std::string& path) {
  Hdf5Handle type = compound(sizeof(Trigger), path);
  H5Tinsert(type, "p", offsetof(Trigger, polarity), H5T_NATIVE_SHORT);
  H5Tinsert(type, "t", offsetof(Trigger, time), H5T_NATIVE_LLONG);
  H5Tinsert(type, "id", offsetof(Trigger, id), H5T_NATIVE_SHORT);
  return type;
}

void put_text(hid_t object, const char* name, const std::string& value, const std::string& path) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path), scalar(H5Screate(H5S_SCALAR), H5Sclose, path);
  H5Tset_size(type, H5T_VARIABLE);
  const Hdf5Handle attribute(H5Acreate2(object, name, type, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, path);
  const char* text = value.c_str();
  if (H5Awrite(attribute, type, &text) < 0) throw Error(ErrorCode::io, path, "the HDF5 library refused to write it");
}

Hdf5Handle ecf_set(const std::string& path) {
  Hdf5Handle how = growing_set(kCdChunk, path);
  // The library need not have the filter: chunks are packed here.
  H5Pset_filter(how, ecf::kFilter, H5Z_FLAG_OPTIONAL, 0, nullptr);
  return how;
}

class MetavisionWriter : public EventFileWriter::Format {
 public:
  explicit MetavisionWriter(const EventFilePlan& plan)
      : path_(plan.path),
        file_(plan.path),
        events_(make_set(file_, "CD/events", event_type(path_), ecf_set(path_), path_)),
        indexes_(make_set(file_, "CD/indexes", index_type(path_), growing_set(kCdChunk, path_), path_)) {
    make_set(file_, "EXT_TRIGGER/events", trigger_type(path_), growing_set(kCdChunk, path_), path_);
    make_set(file_, "EXT_TRIGGER/indexes", index_type(path_), growing_set(kCdChunk, path_), path_);
    put_text(file_, "version", "1.0", path_);
    put_text(file_, "geometry", std::to_string(plan.width) + "x" + std::to_string(plan.height), path_);
    put_text(file_, "integrator", "Kairos", path_);
    if (plan.options.labels) labels_.emplace(file_, path_);
  }

  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      const int64_t time = microseconds(event.time);
      add_index(time);
      block_.push_back({event.x, event.y, static_cast<int16_t>(event.polarity > 0 ? 1 : 0), time});
      if (block_.size() == kCdChunk) flush();
    }
  }

  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override {
    add(events);
    for (size_t i = 0; labels_ && i < events.size(); ++i) labels_->put(events[i], labels[i]);
  }

  void finish() override {
    flush();
    if (labels_) labels_->flush();
    if (count_ > 0) index_.push_back(newest_);
    put_text(indexes_, "offset", std::to_string(-first_), path_);
    write_index();
    file_.finish();
  }

 private:
  /// Row k + 1 tells of the first event of period k, or repeats the row before where there is none; row 0 of none.
  void add_index(int64_t time) {
    if (count_ == 0) first_ = time;
    const int64_t since = time - first_;
    const auto period = static_cast<uint64_t>(since / kIndexPeriod);
    if (count_ == 0) {
      index_.push_back({0, -1});
      newest_ = {0, 0};
    } else if (period > period_) {
      for (; period_ < period; ++period_) index_.push_back(newest_);
      newest_ = {count_, since};
    }
    ++count_;
  }
  void write_index() {
    const hsize_t size = index_.size();
    if (size == 0) return;
    if (H5Dset_extent(indexes_, &size) < 0 ||
        H5Dwrite(indexes_, index_type(path_), H5S_ALL, H5S_ALL, H5P_DEFAULT, index_.data()) < 0)
      refuse();
  }

  void flush() {
    if (block_.empty()) return;
    const std::vector<uint8_t> chunk = ecf::encode(block_);
    const hsize_t begin = written_, end = written_ + block_.size();
    if (H5Dset_extent(events_, &end) < 0 ||
        H5Dwrite_chunk(events_, H5P_DEFAULT, 0, &begin, chunk.size(), chunk.data()) < 0)
      refuse();
    written_ = end;
    block_.clear();
  }
  [[noreturn]] void refuse() const { throw Error(ErrorCode::io, path_, "cannot be written: the HDF5 library refused"); }

  std::string path_;
  Hdf5Output file_;
  Hdf5Handle events_, indexes_;
  std::optional<LabelSets> labels_;
  std::vector<CdEvent> block_;
  std::vector<Index> index_;  // one of 16 bytes every 2 ms
  Index newest_;
  hsize_t written_ = 0;
  uint64_t count_ = 0, period_ = 0;
  int64_t first_ = 0;
};

/// Reads chunk by chunk, whatever packs them.
class EventsReader {
 public:
  EventsReader(hid_t file, const std::string& path)
      : path_(path + ": CD/events"),
        set_(H5Dopen2(file, "CD/events", H5P_DEFAULT), H5Dclose, path_),
        space_(H5Dget_space(set_), H5Sclose, path_),
        how_(H5Dget_create_plist(set_), H5Pclose, path_) {
    hsize_t size = 0;
    if (H5Sget_simple_extent_ndims(space_) != 1 || H5Sget_simple_extent_dims(space_, &size, nullptr) < 0)
      throw Error(ErrorCode::bad_input, path_, "is no list of events");
    size_ = size;
    unsigned flags = 0, detail = 0;
    size_t details = 0;
    is_ecf_ = H5Pget_filter_by_id2(how_, ecf::kFilter, &flags, &details, &detail, 0, nullptr, nullptr) >= 0;
    if (is_ecf_ && (H5Pget_chunk(how_, 1, &chunk_) != 1 || chunk_ > ecf::kMostEvents))
      throw Error(ErrorCode::bad_input, path_, "has chunks that are too large for ECF");
  }

  uint64_t size() const { return size_; }
  uint64_t step() const { return chunk_; }
  /// The events from a multiple of step() on.
  std::vector<CdEvent> read(uint64_t begin) {
    const hsize_t from = begin, count = std::min<uint64_t>(chunk_, size_ - begin);
    std::vector<CdEvent> events = is_ecf_ ? read_packed(from) : read_plain(from, count);
    if (events.size() < count) throw Error(ErrorCode::bad_input, path_, "has chunks with too few events");
    events.resize(count);
    return events;
  }

 private:
  std::vector<CdEvent> read_packed(hsize_t from) {
    hsize_t bytes = 0;
    // Of one chunk at its worst: each event has a long step in time.
    constexpr hsize_t kMost = 12 + ecf::kMostEvents * hsize_t{32};
    if (H5Dget_chunk_storage_size(set_, &from, &bytes) < 0 || bytes == 0 || bytes > kMost) refuse();
    std::vector<uint8_t> packed(bytes);
    uint32_t left_out = 0;
    if (H5Dread_chunk(set_, H5P_DEFAULT, &from, &left_out, packed.data()) < 0 || left_out != 0) refuse();
    return ecf::decode(packed, path_);
  }
  std::vector<CdEvent> read_plain(hsize_t from, hsize_t count) {
    std::vector<CdEvent> events(count);
    const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    if (H5Sselect_hyperslab(space_, H5S_SELECT_SET, &from, nullptr, &count, nullptr) < 0 ||
        H5Dread(set_, event_type(path_), memory, space_, H5P_DEFAULT, events.data()) < 0)
      refuse();
    return events;
  }
  [[noreturn]] void refuse() const {
    throw Error(ErrorCode::bad_input, path_, "cannot be read: broken, or compressed in a way that needs a plugin");
  }

  std::string path_;
  Hdf5Handle set_, space_, how_;
  uint64_t size_ = 0;
  hsize_t chunk_ = kCdChunk;
  bool is_ecf_ = false;
};

/// "1280x720" of the file's attribute, or 0 and 0.
void read_geometry(hid_t file, EventFileFacts& facts) {
  if (H5Aexists(file, "geometry") <= 0) return;
  const Hdf5Handle attribute(H5Aopen(file, "geometry", H5P_DEFAULT), H5Aclose, "geometry"),
      type(H5Aget_type(attribute), H5Tclose, "geometry"), space(H5Aget_space(attribute), H5Sclose, "geometry");
  if (H5Tis_variable_str(type) <= 0 || H5Sget_simple_extent_npoints(space) != 1) return;
  char* text = nullptr;
  if (H5Aread(attribute, type, static_cast<void*>(&text)) < 0 || text == nullptr) return;
  const std::string geometry = text;
  H5free_memory(text);
  int width = 0, height = 0;
  const char* end = geometry.data() + geometry.size();
  const auto across = std::from_chars(geometry.data(), end, width);
  if (across.ec != std::errc{} || across.ptr == end || *across.ptr != 'x') return;
  if (std::from_chars(across.ptr + 1, end, height).ec != std::errc{}) return;
  constexpr int kMost = 65536;
  if (width > 0 && height > 0 && width <= kMost && height <= kMost) facts.width = width, facts.height = height;
}

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_metavision_writer(const EventFilePlan& plan) {
  return std::make_unique<MetavisionWriter>(plan);
}

EventFileFacts read_metavision(const std::string& path, hid_t file, EventSink& sink) {
  EventFileFacts facts{"Metavision", 0, 0};
  read_geometry(file, facts);
  EventsReader reader(file, path);
  LabelReader labels(file, path, reader.size());
  EventBlock block(sink);
  for (uint64_t begin = 0; begin < reader.size(); begin += reader.step()) {
    const std::vector<CdEvent> events = reader.read(begin);
    labels.read(begin, events.size());
    for (size_t i = 0; i < events.size(); ++i) {
      const CdEvent& event = events[i];
      if (event.time < 0 || event.time > INT64_MAX / 1000 || event.polarity < -1 || event.polarity > 1)
        throw Error(ErrorCode::bad_input, path, "has an event with a time or a polarity that no event has");
      block.add_with(labels, i, event.time * 1000, event.x, event.y, event.polarity > 0);
    }
  }
  block.flush();
  return facts;
}

}  // namespace kairos
