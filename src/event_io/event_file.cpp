#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iterator>

#include <kairos/error.h>
#include <kairos/event_file.h>

#include "base/file.h"
#include "event_io/event_format.h"

namespace kairos {

namespace {

using Time = EventFileOptions::Time;

/// Of everything that is read into memory: 64 GB.
constexpr uint64_t kMostBytes = uint64_t{1} << 36;

using MakeWriter = std::unique_ptr<EventFileWriter::Format> (*)(const EventFilePlan& plan);
using ReadBytes = EventFileFacts (*)(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink);

struct Kind {
  const char* ending;
  MakeWriter make;
  ReadBytes read;  // null: the file is opened by a library
  int most_side;   // pixels
};

const std::array<Kind, 9>& kinds() {
  static constexpr std::array<Kind, 9> all{{
      {".npz", make_npz_writer, read_npz, 65536},
      {".npy", make_npy_writer, read_npy, 65536},
      {".txt", make_text_writer, read_event_text, 65536},
      {".raw", make_raw_writer, read_raw, 2048},
      {".h5", make_dsec_writer, nullptr, 65536},
      {".hdf5", make_metavision_writer, nullptr, 2048},
      {".aedat4", make_aedat4_writer, read_aedat4, 32768},
      {".aedat", make_aedat2_writer, nullptr, 640},
      {".dat", make_dat_writer, read_dat, 16384},
  }};
  return all;
}

const Kind& kind_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  for (const Kind& kind : kinds())
    if (ending == kind.ending) return kind;
  throw Error(ErrorCode::bad_usage, path,
              "is no name of a file of events; let it end in one of " + event_file_endings());
}

}  // namespace

std::string event_file_endings() {
  std::string names;
  for (const Kind& kind : kinds()) names += (names.empty() ? "" : ", ") + std::string(kind.ending);
  return names;
}

bool holds_labels(const std::string& path) {
  const std::string ending = kind_of(path).ending;
  return ending == ".npz" || ending == ".npy" || ending == ".h5" || ending == ".hdf5";
}

void check_event_file(const std::string& path, int width, int height, const EventFileOptions& options) {
  const Kind& kind = kind_of(path);
  const std::string ending = kind.ending;
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::bad_usage, path, why); };
  if (std::max(width, height) > kind.most_side)
    refuse(ending + " has no places beyond " + std::to_string(kind.most_side) + " pixels; write another format");
  if (options.epoch < 0) refuse("the epoch must not be before 0");
  const bool text = ending == ".txt", npz = ending == ".npz";
  if (options.time && ((!text && !npz) || (npz && *options.time == Time::seconds)))
    refuse(
        "times are seconds (with nine decimals), microseconds or nanoseconds in .txt, microseconds or nanoseconds in "
        ".npz, and cannot be chosen in others");
  if (options.polarity && !text && !npz) refuse("how polarity is written can be chosen for .txt and .npz alone");
  if (text && options.time == Time::nanoseconds && options.header != EventFileOptions::Header::none)
    refuse("a file of nanoseconds has a first line of its own, and no other header");
  if (options.labels && !holds_labels(path)) refuse("labels of events are of .npz, .npy, .h5 and .hdf5 alone");
  if (options.header != EventFileOptions::Header::none && !text) refuse("a header is of .txt alone");
}

EventFileWriter::EventFileWriter(const std::string& path, int width, int height, const EventFileOptions& options)
    : epoch_(options.epoch) {
  if (width < 1 || height < 1) throw Error(ErrorCode::bad_usage, path, "a sensor has pixels");
  check_event_file(path, width, height, options);
  const Kind& kind = kind_of(path);
  if (kind.make == make_dsec_writer) epoch_ = 0;  // which it holds apart
  format_ = kind.make({path, width, height, options});
}
EventFileWriter::~EventFileWriter() = default;

std::span<const Event> EventFileWriter::shifted(std::span<const Event> events) {
  if (epoch_ == 0) return events;
  shifted_.assign(events.begin(), events.end());
  for (Event& event : shifted_) event.time += epoch_;
  return shifted_;
}

void EventFileWriter::add(std::span<const Event> events) { format_->add(shifted(events)); }
void EventFileWriter::add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) {
  format_->add_labelled(shifted(events), labels);
}

void EventFileWriter::finish() { format_->finish(); }

EventFileFacts read_events(const std::string& path, EventSink& sink) {
  const Kind& kind = kind_of(path);
  if (kind.make == make_dsec_writer || kind.make == make_metavision_writer) return read_hdf5(path, sink);
  if (kind.read == nullptr)
    throw Error(ErrorCode::bad_usage, path, "AEDAT-2.0 is written, but not read; use another format");
  const std::vector<uint8_t> bytes = read_file(path, kMostBytes);
  return kind.read(path, bytes, sink);
}

}  // namespace kairos
