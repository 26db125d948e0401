// HDF5 files of events laid out as those of DSEC (M. Gehrig, W. Aarents, D. Gehrig, D. Scaramuzza 2021).
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "event_io/event_format.h"
#include "event_io/hdf5_numbers.h"
#include "event_io/hdf5_readers.h"

namespace kairos {

namespace {

class DsecWriter : public EventFileWriter::Format {
 public:
  explicit DsecWriter(const EventFilePlan& plan)
      : plan_(plan),
        file_(plan.path),
        t_(file_, "events/t", uint32_t{}, plan.path),
        x_(file_, "events/x", uint16_t{}, plan.path),
        y_(file_, "events/y", uint16_t{}, plan.path),
        p_(file_, "events/p", uint8_t{}, plan.path),
        index_(file_, "ms_to_idx", uint64_t{}, plan.path) {
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
      p_.put(static_cast<uint8_t>(event.polarity > 0));
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
    for (auto* set : {&t_, &x_, &y_, &p_, &index_}) set->flush();
    file_.finish();
  }

 private:
  /// Entries up to this millisecond: how many events are before each.
  void index_to(int64_t millisecond) {
    for (; indexed_ <= millisecond; ++indexed_) index_.put(count_);
  }

  EventFilePlan plan_;
  Hdf5Output file_;
  NumberSet t_, x_, y_, p_, index_;
  std::optional<LabelSets> labels_;
  int64_t indexed_ = 0;
  uint64_t count_ = 0;
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
  LabelReader labels(file, path, columns[0].size());
  EventBlock block(sink);
  std::array<std::vector<int64_t>, 4> values;
  for (uint64_t begin = 0; begin < columns[0].size(); begin += NumberSet::kChunk) {
    const uint64_t count = std::min<uint64_t>(NumberSet::kChunk, columns[0].size() - begin);
    for (size_t c = 0; c < 4; ++c) {
      values[c].resize(count);
      columns[c].read(begin, values[c]);
    }
    labels.read(begin, count);
    for (size_t i = 0; i < values[0].size(); ++i) {
      const int64_t t = values[0][i], x = values[1][i], y = values[2][i], p = values[3][i];
      if (t < 0 || t > INT64_MAX / 1000 || x < 0 || x > 65535 || y < 0 || y > 65535 || p < -1 || p > 1)
        throw Error(ErrorCode::bad_input, path,
                    "event " + std::to_string(begin + i) + " has a time, a place or a polarity that no event has");
      block.add_with(labels, i, t * 1000, static_cast<uint64_t>(x), static_cast<uint64_t>(y), p > 0);
    }
  }
  block.flush();
  return {"DSEC", 0, 0};
}

}  // namespace kairos
