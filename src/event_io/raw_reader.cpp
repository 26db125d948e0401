// Reads RAW files of Prophesee's sensors: EVT2, EVT2.1 and EVT3.
#include <kairos/error.h>

#include "event_io/event_format.h"
#include "event_io/evt_words.h"
#include "event_io/percent_header.h"

namespace kairos {

namespace {

void read_evt2(std::span<const uint8_t> bytes, EventBlock& block) {
  uint64_t high = 0;
  for (; bytes.size() >= 4; bytes = bytes.subspan(4)) {
    const auto word = read_little<uint32_t>(bytes.data());
    const uint32_t type = word >> 28;
    if (type == evt::kTimeHigh2) high = word & 0x0fffffffu;
    if (type != evt::kOff && type != evt::kOn) continue;
    const uint64_t time = high << evt::kTimeBits2 | ((word >> 22) & 63u);
    block.add(static_cast<int64_t>(time) * 1000, (word >> 11) & 0x7ffu, word & 0x7ffu, type == evt::kOn);
  }
}

void read_evt21(std::span<const uint8_t> bytes, EventBlock& block) {
  uint64_t high = 0;
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    const auto word = read_little<uint64_t>(bytes.data());
    const auto type = static_cast<uint32_t>(word >> 60);
    if (type == evt::kTimeHigh2) high = word >> 32 & 0x0fffffffu;
    if (type != evt::kOff && type != evt::kOn) continue;
    const uint64_t time = high << evt::kTimeBits2 | (word >> 54 & 63u), base = word >> 43 & 0x7ffu;
    for (unsigned bit = 0; bit < evt::kVector; ++bit)
      if ((word >> bit & 1u) != 0 && base + bit < evt::kPlaces)
        block.add(static_cast<int64_t>(time) * 1000, base + bit, word >> 32 & 0x7ffu, type == evt::kOn);
  }
}

void read_evt3(std::span<const uint8_t> bytes, EventBlock& block) {
  uint64_t turns = 0, high = 0, low = 0, y = 0, base = 0;
  bool base_on = false;
  const auto add = [&](uint64_t x, bool on) {
    const uint64_t time = (turns << evt::kTimeBits3 | high) << evt::kTimeBits3 | low;
    if (x < evt::kPlaces) block.add(static_cast<int64_t>(time) * 1000, x, y, on);
  };
  for (; bytes.size() >= 2; bytes = bytes.subspan(2)) {
    const auto word = read_little<uint16_t>(bytes.data());
    const uint64_t payload = word & 0xfffu, place = word & 0x7ffu;
    const bool flag = (word >> 11 & 1u) != 0;
    const auto add_bits = [&](int count) {
      for (int bit = 0; bit < count; ++bit)
        if ((payload >> bit & 1u) != 0) add(base + static_cast<uint64_t>(bit), base_on);
      base += static_cast<uint64_t>(count);
    };
    switch (word >> 12) {
      case evt::kAddrY:
        y = place;
        break;
      case evt::kAddrX:
        add(place, flag);
        break;
      case evt::kVectBase:
        base = place;
        base_on = flag;
        break;
      case evt::kVect12:
        add_bits(12);
        break;
      case evt::kVect8:
        add_bits(8);
        break;
      case evt::kTimeLow:
        low = payload;
        break;
      case evt::kTimeHigh3:
        // Down by much: once around. By little, cameras send it again.
        if (payload + 2048 < high) ++turns;
        high = payload;
        break;
      default:  // triggers, and what cameras say of themselves
        break;
    }
  }
}

struct Version {
  const char* name;
  const char* evt;     // what its header's `evt` line says,
  const char* format;  // or its `format` line
  void (*read)(std::span<const uint8_t> bytes, EventBlock& block);
};

constexpr Version kVersions[] = {
    {"EVT3", "% evt 3", "% format EVT3", read_evt3},
    {"EVT2.1", "% evt 2.1", "% format EVT21", read_evt21},
    {"EVT2", "% evt 2.0", "% format EVT2\n", read_evt2},
    {"EVT2", "% evt 2\n", "% format EVT2;", read_evt2},
};

}  // namespace

EventFileFacts read_raw(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  const PercentHeader header(bytes);
  // Cameras of the first EVT2.1 wrote the two halves of a word the other way round.
  if (header.says("EVT21") && (header.says("endianness=legacy") || header.says("endianness=big")))
    throw Error(ErrorCode::bad_input, path, "is EVT2.1 in the legacy order of bytes; convert it to EVT3");
  for (const Version& version : kVersions) {
    if (!header.says(version.evt) && !header.says(version.format)) continue;
    EventBlock block(sink);
    version.read(bytes.subspan(header.size), block);
    block.flush();
    return {version.name, header.number("width="), header.number("height=")};
  }
  throw Error(ErrorCode::bad_input, path, "is no RAW file of the kinds EVT2, EVT2.1 and EVT3, or does not say which");
}

}  // namespace kairos
