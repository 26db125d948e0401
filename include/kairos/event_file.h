// Files of events: what people's loaders read. docs/events.md.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <kairos/events.h>
#include <kairos/export.h>

namespace kairos {

struct EventFileOptions {
  enum class Time { seconds, microseconds, nanoseconds };  ///< microseconds and coarser: cut off, as counters do
  enum class Polarity {
    zero_one,  ///< 0: darker, 1: brighter
    signs,     ///< -1: darker, 1: brighter
  };
  enum class Header {
    none,   ///< of text: nothing but events
    e2vid,  ///< "WIDTH HEIGHT"
    v2e,    ///< lines that begin with #; a fifth column says 1 for the signal and 0 for noise
  };
  std::optional<Time> time;          ///< of text and npz (not seconds); unset: as is usual
  std::optional<Polarity> polarity;  ///< of text and npz; unset: as is usual
  Header header = Header::none;
  enum class Evt { evt2, evt21, evt3 };  ///< versions 2, 2.1 and 3
  Evt evt = Evt::evt3;                   ///< of .raw
  int64_t epoch = 0;                     ///< nanoseconds that are added to all stamps; 0 or more
  bool kinds = false;                    ///< npz: an array that tells signal and noise apart
  bool labels = false;                   ///< npz, npy, h5, hdf5: what made each pixel fire
  int64_t duration = 0;                  ///< nanoseconds: of the recording; .h5 has an index of all of its milliseconds
};

/// A file that is being written: there whole, or not at all. Its ending chooses what it is (event_file_endings).
class KAIROS_API EventFileWriter : public EventSink {
 public:
  /// Throws Error(bad_usage) for an ending, a size or options that cannot be; Error(io) when it cannot be written.
  EventFileWriter(const std::string& path, int width, int height, const EventFileOptions& options = {});
  ~EventFileWriter() override;

  void add(std::span<const Event> events) override;
  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override;
  /// Gives the file its name. Without it nothing is left behind.
  void finish();

  class Format;

 private:
  std::unique_ptr<Format> format_;
  std::span<const Event> shifted(std::span<const Event> events);

  int64_t epoch_;
  std::vector<Event> shifted_;
};

/// Throws Error(bad_usage) that names the endings there are when `path` has none of them, or a size that the format
/// does not hold. Sizes of 0 are not looked at.
KAIROS_API void check_event_file(const std::string& path, int width = 0, int height = 0,
                                 const EventFileOptions& options = {});
/// Has the format of this name a place for labels? Throws what check_event_file does.
KAIROS_API bool holds_labels(const std::string& path);
/// ".npz, .txt, ..."
KAIROS_API std::string event_file_endings();

/// What a file says of itself.
struct EventFileFacts {
  std::string format;         ///< "npz", "text", "EVT3", ...
  int width = 0, height = 0;  ///< 0: it does not say
};

/// Reads what EventFileWriter writes, and others' of these formats. `sink` gets all events in the file's order, at
/// microseconds where the file has no finer ones, and labels where it has them. Throws Error(bad_input) or Error(io).
KAIROS_API EventFileFacts read_events(const std::string& path, EventSink& sink);

/// A sensor's parameters from JSON: what stands beside a recording, or an object with some of what is under "sensor" in
/// it; others are an ideal sensor's. Throws Error(bad_input) or Error(io).
KAIROS_API EventSensor read_event_sensor(const std::string& path);

/// Writes beside a recording what it is and how it was made, as JSON. Throws Error(io).
KAIROS_API void write_event_notes(const std::string& path, const EventOptions& options, const EventStats& stats,
                                  const std::string& command_line);

}  // namespace kairos
