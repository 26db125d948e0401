// A recording that survives being killed: what is done is kept beside it, and found by whoever runs the same command
// again.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <kairos/event_file.h>
#include <kairos/events.h>

namespace kairos::cli {

/// Hands events on, and keeps them in a folder, OUT.unfinished.
class EventCheckpoints : public EventSink {
 public:
  /// mark: as in frame_mark.h. seconds: at most so much work is lost, and one chunk more. labels: of the recording.
  /// Throws Error(bad_input) where the folder holds another recording.
  EventCheckpoints(const std::string& out, std::string mark, double seconds, bool labels, EventSink& next);

  /// Hands on what an earlier run has kept. Returns what record_events resumes with, empty where there is nothing.
  std::vector<uint8_t> resume(int width, int height);
  /// When the recording is where it belongs.
  void remove() const;

  void add(std::span<const Event> events) override;
  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override;
  void end_chunk(const std::function<std::vector<uint8_t>()>& state) override;

 private:
  std::string part(uint64_t number) const;
  void begin_part();

  std::string folder_, mark_;
  double seconds_;
  bool labels_;
  EventSink& next_;
  int width_ = 0, height_ = 0;
  uint64_t parts_ = 0;  // that are kept
  std::unique_ptr<EventFileWriter> file_;
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
};

}  // namespace kairos::cli
