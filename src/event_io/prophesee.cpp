// Files of Prophesee's sensors: EVT2 and EVT3 (.raw) and DAT, as openeb's decoders read them.
#include <charconv>
#include <string_view>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "event_io/event_format.h"

namespace kairos {

namespace {

// Types of EVT2's words, in their bits 31 to 28.
constexpr uint32_t kOff2 = 0, kOn2 = 1, kTimeHigh2 = 8;
// Types of EVT3's words, in their bits 15 to 12.
constexpr uint16_t kAddrY = 0, kAddrX = 2, kVectBase = 3, kVect12 = 4, kVect8 = 5, kTimeLow = 6, kTimeHigh = 8;
constexpr int kTimeBits2 = 6, kTimeBits3 = 12;
constexpr uint64_t kPlaces = 2048;                                 // of x and of y
constexpr uint64_t kMostTime2 = uint64_t{1} << (28 + kTimeBits2);  // microseconds: nearly five hours

class RawWriter : public EventFileWriter::Format {
 public:
  RawWriter(const EventFilePlan& plan, const std::string& version) : path_(plan.path), file_(plan.path) {
    const std::string width = std::to_string(plan.width), height = std::to_string(plan.height);
    // No date: recordings of the same events are the same.
    header("% camera_integrator_name Kairos\n% plugin_integrator_name Kairos\n% evt " + version + ".0\n% format EVT" +
           version + ";height=" + height + ";width=" + width + "\n% geometry " + width + "x" + height + "\n% end\n");
  }
  void finish() override { file_.commit(); }

 protected:
  void header(const std::string& text) { file_.write(text.data(), text.size()); }
  void flush() {
    file_.write(bytes_.data(), bytes_.size());
    bytes_.clear();
  }

  std::string path_;
  std::vector<uint8_t> bytes_;

 private:
  AtomicFile file_;
};

class Evt2Writer : public RawWriter {
 public:
  explicit Evt2Writer(const EventFilePlan& plan) : RawWriter(plan, "2") { put_high(0); }

  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      const auto time = static_cast<uint64_t>(microseconds(event.time));
      if (time >= kMostTime2)
        throw Error(ErrorCode::bad_usage, path_, "EVT2 has no times beyond 4 h 46 min; write EVT3, or record less");
      if (time >> kTimeBits2 != high_) put_high(time >> kTimeBits2);
      put_little(bytes_, (event.polarity > 0 ? kOn2 : kOff2) << 28 | static_cast<uint32_t>(time & 63) << 22 |
                             uint32_t{event.x} << 11 | uint32_t{event.y});
    }
    flush();
  }

 private:
  void put_high(uint64_t high) {
    high_ = high;
    put_little(bytes_, kTimeHigh2 << 28 | static_cast<uint32_t>(high));
  }
  uint64_t high_ = 0;
};

class Evt3Writer : public RawWriter {
 public:
  explicit Evt3Writer(const EventFilePlan& plan) : RawWriter(plan, "3") { put(kTimeHigh, 0); }

  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      const auto time = static_cast<uint64_t>(microseconds(event.time));
      const uint64_t high = time >> kTimeBits3, low = time & 0xfff;
      bool tell_low = low != low_ || !told_;
      // Readers count the turns of this 12-bit counter: each of its values has to be there, however long nothing fires.
      while (high_ != high) {
        put(kTimeHigh, ++high_ & 0xfff);
        tell_low = true;
      }
      if (tell_low) put(kTimeLow, low);
      if (event.y != y_ || !told_) put(kAddrY, event.y);
      put(kAddrX, uint64_t{event.x} | (event.polarity > 0 ? 1u << 11 : 0));
      low_ = low;
      y_ = event.y;
      told_ = true;
      if (bytes_.size() > kBlock) flush();
    }
    flush();
  }

 private:
  static constexpr size_t kBlock = 1 << 20;

  void put(uint16_t type, uint64_t payload) { put_little(bytes_, static_cast<uint16_t>(type << 12 | payload)); }

  uint64_t high_ = 0, low_ = 0;
  uint16_t y_ = 0;
  bool told_ = false;
};

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

/// Lines that begin with %, and where they end.
struct PercentHeader {
  size_t size = 0;
  std::string text;

  PercentHeader(std::span<const uint8_t> bytes) {
    while (size < bytes.size() && bytes[size] == '%') {
      size_t end = size;
      while (end < bytes.size() && bytes[end] != '\n') ++end;
      const std::string line(bytes.begin() + static_cast<std::ptrdiff_t>(size),
                             bytes.begin() + static_cast<std::ptrdiff_t>(end));
      size = std::min(end + 1, bytes.size());
      text += line + '\n';
      if (line.starts_with("% end")) break;
    }
  }
  bool says(std::string_view what) const { return text.find(what) != std::string::npos; }
  /// The number behind a word; 0 where there is none.
  int number(std::string_view word) const {
    const size_t at = text.find(word);
    int value = 0;
    if (at != std::string::npos) std::from_chars(text.data() + at + word.size(), text.data() + text.size(), value);
    return value >= 0 && value <= 65536 ? value : 0;
  }
};

void read_evt2(std::span<const uint8_t> bytes, EventBlock& block) {
  uint64_t high = 0;
  for (; bytes.size() >= 4; bytes = bytes.subspan(4)) {
    const auto word = read_little<uint32_t>(bytes.data());
    const uint32_t type = word >> 28;
    if (type == kTimeHigh2) high = word & 0x0fffffffu;
    if (type != kOff2 && type != kOn2) continue;
    const uint64_t time = high << kTimeBits2 | ((word >> 22) & 63u);
    block.add(static_cast<int64_t>(time) * 1000, (word >> 11) & 0x7ffu, word & 0x7ffu, type == kOn2);
  }
}

void read_evt3(std::span<const uint8_t> bytes, EventBlock& block) {
  uint64_t turns = 0, high = 0, low = 0, y = 0, base = 0;
  bool base_on = false;
  const auto add = [&](uint64_t x, bool on) {
    const uint64_t time = (turns << kTimeBits3 | high) << kTimeBits3 | low;
    if (x < kPlaces) block.add(static_cast<int64_t>(time) * 1000, x, y, on);
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
      case kAddrY:
        y = place;
        break;
      case kAddrX:
        add(place, flag);
        break;
      case kVectBase:
        base = place;
        base_on = flag;
        break;
      case kVect12:
        add_bits(12);
        break;
      case kVect8:
        add_bits(8);
        break;
      case kTimeLow:
        low = payload;
        break;
      case kTimeHigh:
        // Down by much: once around. By little, cameras send it again.
        if (payload + 2048 < high) ++turns;
        high = payload;
        break;
      default:  // triggers, and what cameras say of themselves
        break;
    }
  }
}

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_evt2_writer(const EventFilePlan& plan) {
  return std::make_unique<Evt2Writer>(plan);
}
std::unique_ptr<EventFileWriter::Format> make_evt3_writer(const EventFilePlan& plan) {
  return std::make_unique<Evt3Writer>(plan);
}
std::unique_ptr<EventFileWriter::Format> make_dat_writer(const EventFilePlan& plan) {
  return std::make_unique<DatWriter>(plan);
}

EventFileFacts read_raw(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  const PercentHeader header(bytes);
  const bool evt3 = header.says("% evt 3") || header.says("% format EVT3");
  const bool evt2 = header.says("% evt 2.0") || header.says("% format EVT2;") || header.says("% format EVT2\n");
  if (evt2 == evt3)
    throw Error(ErrorCode::bad_input, path, "is no RAW file of the kinds EVT2 and EVT3, or does not say which");
  EventFileFacts facts{evt3 ? "EVT3" : "EVT2", header.number("width="), header.number("height=")};
  EventBlock block(sink);
  (evt3 ? read_evt3 : read_evt2)(bytes.subspan(header.size), block);
  block.flush();
  return facts;
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
