// What all kinds of event files have in common.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kairos/event_file.h>

#include "base/little_endian.h"

namespace kairos {

/// Takes events in order, and finishes the file.
class EventFileWriter::Format {
 public:
  virtual ~Format() = default;
  virtual void add(std::span<const Event> events) = 0;
  virtual void add_labelled(std::span<const Event> events, [[maybe_unused]] std::span<const EventLabel> labels) {
    add(events);
  }
  virtual void finish() = 0;
};

/// What a writer is told.
struct EventFilePlan {
  std::string path;
  int width, height;
  EventFileOptions options;
};

inline int64_t microseconds(int64_t nanoseconds) { return nanoseconds / 1000; }  // never negative

// Writers.
std::unique_ptr<EventFileWriter::Format> make_npz_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_npy_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_text_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_raw_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_dat_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_dsec_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_metavision_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_aedat4_writer(const EventFilePlan& plan);
std::unique_ptr<EventFileWriter::Format> make_aedat2_writer(const EventFilePlan& plan);

// Readers of a file's bytes. They hand over events in blocks, and throw Error(bad_input) for what is none.
EventFileFacts read_npz(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
EventFileFacts read_npy(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
EventFileFacts read_event_text(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
EventFileFacts read_raw(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
EventFileFacts read_dat(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
EventFileFacts read_aedat4(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);
/// Of an HDF5 file, which its library opens by itself: laid out like DSEC's or Metavision's.
EventFileFacts read_hdf5(const std::string& path, EventSink& sink);

/// Collects what a reader finds, and hands it over in blocks.
class EventBlock {
 public:
  explicit EventBlock(EventSink& sink) : sink_(sink) {}

  void add(int64_t nanoseconds, uint64_t x, uint64_t y, bool on, EventKind kind = EventKind::signal) {
    events_.push_back(
        {nanoseconds, static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<int8_t>(on ? 1 : -1), kind});
    if (events_.size() == kBlock) flush();
  }
  /// To the event that is added next. Either all have one or none.
  void label_next(const EventLabel& label) { labels_.push_back(label); }
  /// With the label and the kind that stand at `index` of `labels`, where it has() any.
  template <class Labels>
  void add_with(const Labels& labels, uint64_t index, int64_t nanoseconds, uint64_t x, uint64_t y, bool on) {
    if (!labels.has()) return add(nanoseconds, x, y, on);
    const auto all = labels.at(index);
    label_next(all.label);
    add(nanoseconds, x, y, on, all.event_kind());
  }
  void flush() {
    if (!labels_.empty())
      sink_.add_labelled(events_, labels_);
    else if (!events_.empty())
      sink_.add(events_);
    events_.clear();
    labels_.clear();
  }

 private:
  static constexpr size_t kBlock = 1 << 16;

  EventSink& sink_;
  std::vector<Event> events_;
  std::vector<EventLabel> labels_;  // [event], or empty
};

}  // namespace kairos
