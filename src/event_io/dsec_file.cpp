// HDF5 files of events laid out as those of DSEC (M. Gehrig, W. Aarents, D. Gehrig, D. Scaramuzza 2021).
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "event_io/event_format.h"
#include "event_io/hdf5_file.h"
#include "event_io/hdf5_readers.h"

namespace kairos {

namespace {

constexpr hsize_t kChunk = 65536;  // numbers that are compressed together

hid_t type_of(uint8_t /*value*/) { return H5T_NATIVE_UINT8; }
hid_t type_of(uint16_t /*value*/) { return H5T_NATIVE_UINT16; }
hid_t type_of(uint32_t /*value*/) { return H5T_NATIVE_UINT32; }
hid_t type_of(uint64_t /*value*/) { return H5T_NATIVE_UINT64; }
hid_t type_of(float /*value*/) { return H5T_NATIVE_FLOAT; }

/// A growing data set of numbers.
template <class Number>
class NumberSet {
 public:
  NumberSet(hid_t file, const char* name, const std::string& path) : path_(path), set_(make(file, name, path)) {}

  void put(Number value) {
    block_.push_back(value);
    if (block_.size() == kChunk) flush();
  }
  void flush() {
    if (block_.empty()) return;
    const hsize_t begin = size_, count = block_.size(), end = begin + count;
    if (H5Dset_extent(set_, &end) < 0) refuse();
    const Hdf5Handle place(H5Dget_space(set_), H5Sclose, path_),
        memory(H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    if (H5Sselect_hyperslab(place, H5S_SELECT_SET, &begin, nullptr, &count, nullptr) < 0 ||
        H5Dwrite(set_, type_of(Number{}), memory, place, H5P_DEFAULT, block_.data()) < 0)
      refuse();
    size_ = end;
    block_.clear();
  }

 private:
  [[noreturn]] void refuse() const { throw Error(ErrorCode::io, path_, "cannot be written: the HDF5 library refused"); }

  static Hdf5Handle make(hid_t file, const char* name, const std::string& path) {
    const Hdf5Handle how = growing_set(kChunk, path);
    H5Pset_shuffle(how);
    H5Pset_deflate(how, 1);
    return make_set(file, name, type_of(Number{}), how, path);
  }

  std::string path_;
  Hdf5Handle set_;
  std::vector<Number> block_;
  hsize_t size_ = 0;
};

/// What made pixels fire, in a group that the data set does not have.
struct LabelSets {
  NumberSet<uint32_t> surface, behind;
  NumberSet<float> depth, flow_x, flow_y;
  NumberSet<uint8_t> edge, kind;

  LabelSets(hid_t file, const std::string& path)
      : surface(file, "labels/surface", path),
        behind(file, "labels/behind", path),
        depth(file, "labels/depth", path),
        flow_x(file, "labels/flow_x", path),
        flow_y(file, "labels/flow_y", path),
        edge(file, "labels/edge", path),
        kind(file, "labels/kind", path) {}
  void put(const Event& event, const EventLabel& label) {
    surface.put(label.surface);
    behind.put(label.behind);
    depth.put(label.depth);
    flow_x.put(label.flow[0]);
    flow_y.put(label.flow[1]);
    edge.put(static_cast<uint8_t>(label.edge));
    kind.put(static_cast<uint8_t>(event.kind));
  }
  void flush() {
    for (auto* set : {&surface, &behind}) set->flush();
    for (auto* set : {&depth, &flow_x, &flow_y}) set->flush();
    for (auto* set : {&edge, &kind}) set->flush();
  }
};

class DsecWriter : public EventFileWriter::Format {
 public:
  explicit DsecWriter(const EventFilePlan& plan)
      : plan_(plan),
        file_(plan.path),
        t_(file_, "events/t", plan.path),
        x_(file_, "events/x", plan.path),
        y_(file_, "events/y", plan.path),
        p_(file_, "events/p", plan.path),
        index_(file_, "ms_to_idx", plan.path) {
    const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose, plan.path);
    const Hdf5Handle offset(
        H5Dcreate2(file_, "t_offset", H5T_NATIVE_INT64, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
        plan.path);
    if (plan.options.labels) labels_.emplace(file_, plan.path);
    const int64_t microseconds_before = microseconds(plan.options.epoch);
    H5Dwrite(offset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &microseconds_before);
  }

  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      const int64_t time = microseconds(event.time);
      if (time > int64_t{std::numeric_limits<uint32_t>::max()})
        throw Error(ErrorCode::bad_usage, plan_.path, "the layout of DSEC has no times beyond 71 minutes; record less");
      index_to(time / 1000);
      t_.put(static_cast<uint32_t>(time));
      x_.put(event.x);
      y_.put(event.y);
      p_.put(event.polarity > 0 ? 1 : 0);
      ++count_;
    }
  }

  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override {
    add(events);
    for (size_t i = 0; labels_ && i < events.size(); ++i) labels_->put(events[i], labels[i]);
  }

  void finish() override {
    if (labels_) labels_->flush();
    // Readers look up the millisecond in which their window ends, and read nothing where it is not there.
    index_to((plan_.options.duration + 999999) / 1000000);
    for (auto* set : {&x_, &y_}) set->flush();
    t_.flush();
    p_.flush();
    index_.flush();
    file_.finish();
  }

 private:
  /// Entries up to this millisecond: how many events are before each.
  void index_to(int64_t millisecond) {
    for (; indexed_ <= millisecond; ++indexed_) index_.put(count_);
  }

  EventFilePlan plan_;
  Hdf5Output file_;
  NumberSet<uint32_t> t_;
  NumberSet<uint16_t> x_, y_;
  NumberSet<uint8_t> p_;
  NumberSet<uint64_t> index_;
  std::optional<LabelSets> labels_;
  int64_t indexed_ = 0;
  uint64_t count_ = 0;
};

/// Reads a stretch of a data set of numbers.
class NumberReader {
 public:
  NumberReader(hid_t file, const char* name, const std::string& path)
      : path_(path + ": " + name),
        set_(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, path_),
        space_(H5Dget_space(set_), H5Sclose, path_) {
    hsize_t size = 0;
    if (H5Sget_simple_extent_ndims(space_) != 1 || H5Sget_simple_extent_dims(space_, &size, nullptr) < 0)
      throw Error(ErrorCode::bad_input, path_, "is no list of numbers");
    size_ = size;
  }
  uint64_t size() const { return size_; }
  void read(uint64_t begin, std::vector<int64_t>& out) {
    const hsize_t from = begin, count = out.size();
    const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    if (H5Sselect_hyperslab(space_, H5S_SELECT_SET, &from, nullptr, &count, nullptr) < 0 ||
        H5Dread(set_, H5T_NATIVE_INT64, memory, space_, H5P_DEFAULT, out.data()) < 0)
      throw Error(ErrorCode::bad_input, path_, "cannot be read: broken, or compressed in a way that needs a plugin");
  }

 private:
  std::string path_;
  Hdf5Handle set_, space_;
  uint64_t size_ = 0;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_dsec_writer(const EventFilePlan& plan) {
  return std::make_unique<DsecWriter>(plan);
}

EventFileFacts read_dsec(const std::string& path, hid_t file, EventSink& sink) {
  std::array<NumberReader, 4> columns{NumberReader(file, "events/t", path), NumberReader(file, "events/x", path),
                                      NumberReader(file, "events/y", path), NumberReader(file, "events/p", path)};
  for (const NumberReader& column : columns)
    if (column.size() != columns[0].size())
      throw Error(ErrorCode::bad_input, path, "has t, x, y and p of different lengths");
  EventBlock block(sink);
  std::array<std::vector<int64_t>, 4> values;
  for (uint64_t begin = 0; begin < columns[0].size(); begin += kChunk) {
    for (size_t c = 0; c < 4; ++c) {
      values[c].resize(std::min<uint64_t>(kChunk, columns[0].size() - begin));
      columns[c].read(begin, values[c]);
    }
    for (size_t i = 0; i < values[0].size(); ++i) {
      const int64_t t = values[0][i], x = values[1][i], y = values[2][i], p = values[3][i];
      if (t < 0 || t > INT64_MAX / 1000 || x < 0 || x > 65535 || y < 0 || y > 65535 || p < -1 || p > 1)
        throw Error(ErrorCode::bad_input, path,
                    "event " + std::to_string(begin + i) + " has a time, a place or a polarity that no event has");
      block.add(t * 1000, static_cast<uint64_t>(x), static_cast<uint64_t>(y), p > 0);
    }
  }
  block.flush();
  return {"DSEC", 0, 0};
}

}  // namespace kairos
