#include "events/recording_state.h"

#include <cstring>
#include <string>
#include <type_traits>

#include <kairos/error.h>

namespace kairos {

namespace {

constexpr uint64_t kMagic = 0x317274736f72616b;  // "karostr1"

[[noreturn]] void refuse_state() {
  throw Error(ErrorCode::bad_input, "",
              "what was kept of an unfinished recording is broken; remove it, and begin anew");
}

/// Numbers as they lie in memory.
class StateWriter {
 public:
  template <class Value>
  void put(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    const auto* const from = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
  }
  template <class Value>
  void put_all(const std::vector<Value>& values) {
    put(uint64_t{values.size()});
    for (const Value& value : values) put(value);
  }
  std::vector<uint8_t> bytes;
};

class StateReader {
 public:
  explicit StateReader(std::span<const uint8_t> bytes) : left_(bytes) {}

  template <class Value>
  void get(Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (left_.size() < sizeof value) refuse_state();
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
  }
  uint64_t count(size_t item_size) {
    uint64_t items = 0;
    get(items);
    if (items > left_.size() / item_size) refuse_state();
    return items;
  }
  template <class Value>
  void get_all(std::vector<Value>& values) {
    values.resize(count(sizeof(Value)));
    for (Value& value : values) get(value);
  }
  bool at_end() const { return left_.empty(); }

 private:
  std::span<const uint8_t> left_;
};

/// Calls put_or_get(number) for all numbers of a recording's statistics.
template <class Stats, class Body>
void each_number(Stats& stats, const Body& body) {
  body(stats.width);
  body(stats.height);
  for (auto* const count : {&stats.on, &stats.off, &stats.leak, &stats.shot, &stats.edges, &stats.steps, &stats.rays,
                            &stats.shading_samples})
    body(*count);
  body(stats.fastest);
  body(stats.cpu_seconds);
}

/// Of bytes that may be any.
bool is_bool(const bool& value) {
  uint8_t byte = 0;
  std::memcpy(&byte, &value, 1);
  return byte < 2;
}

}  // namespace

std::vector<uint8_t> recording_bytes(const RecordingState& state) {
  StateWriter out;
  out.put(kMagic);
  out.put(state.next_chunk);
  out.put(state.pixels.width);
  out.put(state.pixels.height);
  out.put_all(state.pixels.pixels);
  out.put_all(state.late.events);
  out.put_all(state.late.labels);
  each_number(state.stats, [&](const auto& number) { out.put(number); });
  for (const std::vector<std::string>* texts : {&state.stats.notes, &state.stats.meshes}) {
    out.put(uint64_t{texts->size()});
    for (const std::string& text : *texts) out.put_all(std::vector<char>(text.begin(), text.end()));
  }
  return out.bytes;
}

RecordingState parse_recording(std::span<const uint8_t> bytes) {
  StateReader in(bytes);
  uint64_t magic = 0;
  in.get(magic);
  if (magic != kMagic) refuse_state();
  RecordingState state;
  in.get(state.next_chunk);
  in.get(state.pixels.width);
  in.get(state.pixels.height);
  in.get_all(state.pixels.pixels);
  in.get_all(state.late.events);
  in.get_all(state.late.labels);
  each_number(state.stats, [&](auto& number) { in.get(number); });
  for (std::vector<std::string>* texts : {&state.stats.notes, &state.stats.meshes}) {
    texts->resize(in.count(sizeof(uint64_t)));
    for (std::string& text : *texts) {
      std::vector<char> letters;
      in.get_all(letters);
      text.assign(letters.begin(), letters.end());
    }
  }
  const PixelStates& pixels = state.pixels;
  if (!in.at_end() || pixels.width < 1 || pixels.height < 1 ||
      pixels.pixels.size() != static_cast<uint64_t>(pixels.width) * static_cast<uint64_t>(pixels.height) ||
      (!state.late.labels.empty() && state.late.labels.size() != state.late.events.size()))
    refuse_state();
  for (const PixelState& pixel : pixels.pixels)
    if (!is_bool(pixel.started) || !is_bool(pixel.stale)) refuse_state();
  return state;
}

}  // namespace kairos
