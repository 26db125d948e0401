// Any bytes as a file of events, or as what is kept of an unfinished recording. The first says of which kind.
#include <array>
#include <cstdint>
#include <span>

#include <kairos/error.h>

#include "event_io/ecf.h"
#include "event_io/event_format.h"
#include "event_io/npy.h"
#include "events/recording_state.h"

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
    const size_t which = data[0] % (kReaders.size() + 3);
    if (which < kReaders.size()) {
      kReaders[which]("file", {data + 1, size - 1}, checker);
    } else if (which == kReaders.size() + 2) {
      const kairos::NpyLabels labels("labels", {data + 1, size - 1}, size / 22);
      if (labels.has()) labels.at(size / 22 - 1);
    } else if (which > kReaders.size()) {
      kairos::recording_bytes(kairos::parse_recording({data + 1, size - 1}));
    } else {  // what HDF5 files of Metavision hold in each chunk
      for (const auto& event : kairos::ecf::decode({data + 1, size - 1}, "chunk"))
        if (event.time < 0 || event.x > 2052 || event.y > 2047) __builtin_trap();
    }
  } catch (const kairos::Error&) {
  }
  return 0;
}
