#include "event_io/ecf.h"

#include <algorithm>
#include <array>

#include <kairos/error.h>

#include "base/little_endian.h"

namespace kairos::ecf {

namespace {

// The first word is four times the number of events, and these.
constexpr uint32_t kAllPacked = 2;  // y, x and polarity of an event are together
constexpr uint32_t kXPacked = 1;    // x and polarity are, and y comes in runs
constexpr uint64_t kLong = 15;      // of a step in time: it takes bytes of its own. Of a count: it follows

// ---- writing

/// Steps in time, each with the number of events at its end.
void put_times(std::span<const CdEvent> events, std::vector<uint8_t>& out) {
  int64_t now = events.front().time;
  put_little(out, now);
  while (!events.empty()) {
    auto step = static_cast<uint64_t>(events.front().time - now);
    now = events.front().time;
    if (step >= kLong) {
      for (; step > 0; step >>= 4) out.push_back(static_cast<uint8_t>(kLong << 4 | (step & 15)));  // lowest first
      step = 0;
    }
    const auto count = static_cast<size_t>(
        std::find_if(events.begin(), events.end(), [&](const CdEvent& e) { return e.time != now; }) - events.begin());
    out.push_back(static_cast<uint8_t>(step << 4 | std::min<uint64_t>(count, kLong)));
    if (count >= kLong) put_little(out, static_cast<uint16_t>(count));
    events = events.subspan(count);
  }
}

/// Four events of 24 bits in three words of 32.
void put_places(std::span<const CdEvent> events, std::vector<uint8_t>& out) {
  for (size_t i = 0; i < events.size(); i += 4) {
    std::array<uint32_t, 4> v{};
    for (size_t k = 0; k < 4 && i + k < events.size(); ++k) {
      const CdEvent& event = events[i + k];
      v[k] = uint32_t{event.y} << 12 | uint32_t{event.x} << 1 | static_cast<uint32_t>(event.polarity);
    }
    put_little(out, v[0] << 8 | (v[1] & 0xff));
    put_little(out, v[1] >> 8 << 16 | (v[2] & 0xffff));
    put_little(out, v[2] >> 16 << 24 | v[3]);
  }
}

// ---- reading

class Reader {
 public:
  Reader(std::span<const uint8_t> bytes, const std::string& place) : bytes_(bytes), place_(place) {}

  std::vector<CdEvent> events() {
    const auto head = take<uint32_t>();
    const size_t count = head >> 2;
    if (count == 0 || count > kMostEvents) fail();
    events_.resize(count);
    take_times();
    if ((head & kAllPacked) != 0) {
      take_all();
    } else {
      in_runs<uint16_t>(5, [](CdEvent& event, uint64_t y) { event.y = static_cast<uint16_t>(y); });
      if ((head & kXPacked) != 0) {
        take_packed_x();
      } else {
        take_neighbours();
        in_runs<uint8_t>(7, [](CdEvent& event, uint64_t p) { event.polarity = static_cast<int16_t>(p); });
      }
    }
    return std::move(events_);
  }

 private:
  [[noreturn]] void fail() const { throw Error(ErrorCode::bad_input, place_, "holds events that are no sound ECF"); }
  template <class Number>
  Number take() {
    if (bytes_.size() < sizeof(Number)) fail();
    const auto value = read_little<Number>(bytes_.data());
    bytes_ = bytes_.subspan(sizeof(Number));
    return value;
  }

  void take_times() {
    auto now = take<uint64_t>();
    for (size_t i = 0; i < events_.size();) {
      const auto byte = take<uint8_t>();
      uint64_t step = byte >> 4, count = byte & 15u;
      if (step == kLong) {
        step = count;
        auto next = take<uint8_t>();
        for (unsigned shift = 4; next >> 4 == kLong; shift += 4, next = take<uint8_t>()) {
          if (shift > 60) fail();
          step |= uint64_t{next & 15u} << shift;
        }
        now += step;
        step = next >> 4;
        count = next & 15u;
      }
      now += step;
      if (count == kLong) count = take<uint16_t>();
      if (now > INT64_MAX || count > events_.size() - i) fail();
      for (; count > 0; --count) events_[i++].time = static_cast<int64_t>(now);
    }
  }

  /// A word is a value and, in its lower `bits`, for how many events it holds; where all of those are set, the number
  /// follows in 16 bits.
  template <class Word, class Set>
  void in_runs(unsigned bits, const Set& set) {
    const uint64_t all = (uint64_t{1} << bits) - 1;
    for (size_t i = 0; i < events_.size();) {
      const uint64_t word = take<Word>();
      uint64_t count = word & all;
      if (count == all) count = take<uint16_t>();
      if (count > events_.size() - i) fail();
      for (; count > 0; --count) set(events_[i++], word >> bits);
    }
  }

  /// An x, and which of the five to its right follow.
  void take_neighbours() {
    constexpr unsigned kNeighbours = 5;
    for (size_t i = 0; i < events_.size();) {
      const auto word = take<uint16_t>();
      events_[i++].x = static_cast<uint16_t>(word >> kNeighbours);
      for (unsigned k = 1; k <= kNeighbours && i < events_.size(); ++k)
        if ((word >> (kNeighbours - k) & 1u) != 0) events_[i++].x = static_cast<uint16_t>((word >> kNeighbours) + k);
    }
  }

  /// Four events of 12 bits in three words of 16.
  void take_packed_x() {
    for (size_t i = 0; i < events_.size(); i += 4) {
      const uint32_t a = take<uint16_t>(), b = take<uint16_t>(), c = take<uint16_t>();
      const std::array<uint32_t, 4> v{a >> 4, (a & 15u) | b >> 8 << 4, (b & 0xffu) | c >> 12 << 8, c & 0xfffu};
      for (size_t k = 0; k < 4 && i + k < events_.size(); ++k) set_x(events_[i + k], v[k]);
    }
  }
  void take_all() {
    for (size_t i = 0; i < events_.size(); i += 4) {
      const auto a = take<uint32_t>(), b = take<uint32_t>(), c = take<uint32_t>();
      const std::array<uint32_t, 4> v{a >> 8, (a & 0xffu) | b >> 16 << 8, (b & 0xffffu) | c >> 24 << 16, c & 0xffffffu};
      for (size_t k = 0; k < 4 && i + k < events_.size(); ++k) {
        set_x(events_[i + k], v[k]);
        events_[i + k].y = static_cast<uint16_t>(v[k] >> 12 & 0x7ffu);
      }
    }
  }
  static void set_x(CdEvent& event, uint32_t packed) {
    event.x = static_cast<uint16_t>(packed >> 1 & 0x7ffu);
    event.polarity = static_cast<int16_t>(packed & 1u);
  }

  std::span<const uint8_t> bytes_;
  const std::string& place_;
  std::vector<CdEvent> events_;
};

}  // namespace

std::vector<uint8_t> encode(std::span<const CdEvent> events) {
  std::vector<uint8_t> out;
  put_little(out, static_cast<uint32_t>(events.size()) << 2 | kAllPacked);
  put_times(events, out);
  put_places(events, out);
  return out;
}

std::vector<CdEvent> decode(std::span<const uint8_t> bytes, const std::string& place) {
  return Reader(bytes, place).events();
}

}  // namespace kairos::ecf
