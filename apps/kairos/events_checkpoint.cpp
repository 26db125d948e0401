#include "events_checkpoint.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/event_parts.h>
#include <kairos/files.h>

namespace kairos::cli {

namespace {

/// Of the file of the recording's state: the mark, how many parts there are, and then the state.
struct Kept {
  std::string mark;
  uint64_t parts = 0;
  std::vector<uint8_t> state;
};

std::string state_file(const std::string& folder) { return folder + "/state"; }

Kept read_kept(const std::string& folder, size_t mark_size) {
  std::ifstream file(state_file(folder), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Kept kept;
  if (bytes.size() < mark_size + sizeof kept.parts) return kept;
  kept.mark = bytes.substr(0, mark_size);
  std::memcpy(&kept.parts, bytes.data() + mark_size, sizeof kept.parts);
  kept.state.assign(bytes.begin() + static_cast<std::ptrdiff_t>(mark_size + sizeof kept.parts), bytes.end());
  return kept;
}

}  // namespace

EventCheckpoints::EventCheckpoints(const std::string& out, std::string mark, double seconds, bool labels,
                                   EventSink& next)
    : folder_(out + ".unfinished"), mark_(std::move(mark)), seconds_(seconds), labels_(labels), next_(next) {
  std::error_code failure;
  std::filesystem::create_directories(folder_, failure);
  if (failure) throw Error(ErrorCode::io, folder_, "cannot be made: " + failure.message());
}

std::string EventCheckpoints::part(uint64_t number) const { return folder_ + fmt::format("/events_{:06}.npz", number); }

void EventCheckpoints::begin_part() {
  EventFileOptions of_recording;
  of_recording.labels = labels_;
  file_ = std::make_unique<EventFileWriter>(part(parts_), width_, height_, event_part_options(of_recording));
}

std::vector<uint8_t> EventCheckpoints::resume(int width, int height) {
  width_ = width;
  height_ = height;
  Kept kept;
  if (std::filesystem::exists(state_file(folder_))) {
    kept = read_kept(folder_, mark_.size());
    if (kept.mark != mark_)
      throw Error(
          ErrorCode::bad_input, folder_,
          "holds another recording: scene files, options, kairos or instruction sets were others; remove it, or "
          "give the recording another name");
  }
  for (; parts_ < kept.parts; ++parts_) read_events(part(parts_), next_);
  begin_part();
  return kept.state;
}

void EventCheckpoints::remove() const {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void EventCheckpoints::add(std::span<const Event> events) {
  next_.add(events);
  file_->add(events);
}

void EventCheckpoints::add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) {
  next_.add_labelled(events, labels);
  file_->add_labelled(events, labels);
}

void EventCheckpoints::end_chunk(const std::function<std::vector<uint8_t>()>& state) {
  if (std::chrono::duration<double>(std::chrono::steady_clock::now() - written_).count() < seconds_) return;
  file_->finish();
  ++parts_;
  const std::vector<uint8_t> bytes = state();
  std::string text = mark_;
  text.append(reinterpret_cast<const char*>(&parts_), sizeof parts_);
  text.append(bytes.begin(), bytes.end());
  write_file(state_file(folder_), text);
  begin_part();
  written_ = std::chrono::steady_clock::now();
}

}  // namespace kairos::cli
