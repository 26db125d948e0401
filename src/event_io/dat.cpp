// Prophesee's older files of events, DAT, as openeb's decoders read them.
#include <string>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "event_io/event_format.h"
#include "event_io/percent_header.h"

namespace kairos {

namespace {

class DatWriter : public EventFileWriter::Format {
 public:
  explicit DatWriter(const EventFilePlan& plan) : path_(plan.path), file_(plan.path) {
    const std::string header = "% Data file containing CD events\n% Version 2\n% Width " + std::to_string(plan.width) +
                               "\n% Height " + std::to_string(plan.height) + "\n% end\n" + std::string{12, 8};
    file_.write(header.data(), header.size());
  }
  void add(std::span<const Event> events) override {
    bytes_.clear();
    for (const Event& event : events) {
      const int64_t time = microseconds(event.time);
      if (time > int64_t{0xffffffff})
        throw Error(ErrorCode::bad_usage, path_, "DAT has no times beyond 71 minutes; write another format");
      put_little(bytes_, static_cast<uint32_t>(time));
      put_little(bytes_, uint32_t{event.x} | uint32_t{event.y} << 14 | (event.polarity > 0 ? 1u << 28 : 0));
    }
    file_.write(bytes_.data(), bytes_.size());
  }
  void finish() override { file_.commit(); }

 private:
  std::string path_;
  AtomicFile file_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_dat_writer(const EventFilePlan& plan) {
  return std::make_unique<DatWriter>(plan);
}

EventFileFacts read_dat(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  const PercentHeader header(bytes);
  constexpr size_t kEventSize = 8;
  if (header.size == 0 || bytes.size() < header.size + 2 || bytes[header.size + 1] != kEventSize ||
      (bytes[header.size] != 12 && bytes[header.size] != 0))
    throw Error(ErrorCode::bad_input, path, "is no DAT file of events");
  EventBlock block(sink);
  for (auto rest = bytes.subspan(header.size + 2); rest.size() >= kEventSize; rest = rest.subspan(kEventSize)) {
    const auto place = read_little<uint32_t>(&rest[4]);
    block.add(int64_t{read_little<uint32_t>(rest.data())} * 1000, place & 0x3fffu, place >> 14 & 0x3fffu,
              (place >> 28 & 1u) != 0);
  }
  block.flush();
  return {"DAT", header.number("Width "), header.number("Height ")};
}

}  // namespace kairos
