// Any bytes as a file of events. The first says of which kind.
#include <array>
#include <cstdint>
#include <span>

#include <kairos/error.h>

#include "event_io/event_format.h"

namespace {

/// Nothing that a reader hands over may be out of range.
class Checker : public kairos::EventSink {
 public:
  void add(std::span<const kairos::Event> events) override {
    for (const kairos::Event& event : events)
      if (event.time < 0 || (event.polarity != 1 && event.polarity != -1)) __builtin_trap();
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr std::array kReaders{kairos::read_npz, kairos::read_npy, kairos::read_event_text,
                                kairos::read_raw, kairos::read_dat, kairos::read_aedat4};
  if (size == 0) return 0;
  Checker checker;
  try {
    kReaders[data[0] % kReaders.size()]("file", {data + 1, size - 1}, checker);
  } catch (const kairos::Error&) {
  }
  return 0;
}
