// Writes RAW files of Prophesee's sensors: EVT2, EVT2.1 and EVT3, as openeb's decoders read them.
#include <string>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "event_io/event_format.h"
#include "event_io/evt_words.h"

namespace kairos {

namespace {

uint64_t ticks(const Event& event) { return static_cast<uint64_t>(microseconds(event.time)); }

/// What all of them have in common. Events of one microsecond and polarity in a row, from left to right, come together.
class RawWriter : public EventFileWriter::Format {
 public:
  /// name: of the version, as its `format` line has it, and as its `evt` line does.
  RawWriter(const EventFilePlan& plan, const std::string& name, const std::string& version)
      : path_(plan.path), file_(plan.path) {
    const std::string width = std::to_string(plan.width), height = std::to_string(plan.height);
    // No date: recordings of the same events are the same.
    const std::string text = "% camera_integrator_name Kairos\n% plugin_integrator_name Kairos\n% evt " + version +
                             "\n% format " + name + ";height=" + height + ";width=" + width + "\n% geometry " + width +
                             "x" + height + "\n% end\n";
    file_.write(text.data(), text.size());
  }

  void add(std::span<const Event> events) final {
    for (const Event& event : events) {
      if (!row_.empty()) {
        const Event& last = row_.back();
        if (ticks(event) != ticks(last) || event.y != last.y || event.polarity != last.polarity || event.x <= last.x)
          end_row();
      }
      row_.push_back(event);
      if (bytes_.size() > kBlock) flush();
    }
    flush();
  }
  void finish() final {
    end_row();
    flush();
    file_.commit();
  }

 protected:
  /// One event at least.
  virtual void put_row(std::span<const Event> row) = 0;

  /// Those of the first events of a row that lie before a place.
  static std::span<const Event> before(std::span<const Event> row, unsigned x) {
    size_t count = 0;
    while (count < row.size() && row[count].x < x) ++count;
    return row.first(count);
  }

  std::string path_;
  std::vector<uint8_t> bytes_;

 private:
  static constexpr size_t kBlock = 1 << 20;

  void end_row() {
    if (!row_.empty()) put_row(row_);
    row_.clear();
  }
  void flush() {
    file_.write(bytes_.data(), bytes_.size());
    bytes_.clear();
  }

  AtomicFile file_;
  std::vector<Event> row_;
};

/// The time of EVT2 and EVT2.1: a word of its own for what is above its lower 6 bits, when that changes.
class Evt2Time {
 public:
  /// Calls put(high) where it has to be told. Throws Error(bad_usage, path) for times that do not fit.
  template <class Put>
  void tell(uint64_t time, const std::string& path, const Put& put) {
    if (time >= evt::kMostTime2)
      throw Error(ErrorCode::bad_usage, path, "EVT2 has no times beyond 4 h 46 min; write EVT3, or record less");
    if (time >> evt::kTimeBits2 == high_) return;
    high_ = time >> evt::kTimeBits2;
    put(high_);
  }

 private:
  uint64_t high_ = 0;
};

class Evt2Writer : public RawWriter {
 public:
  explicit Evt2Writer(const EventFilePlan& plan) : RawWriter(plan, "EVT2", "2.0") { put_high(0); }

 private:
  void put_row(std::span<const Event> row) override {
    for (const Event& event : row) {
      const uint64_t time = ticks(event);
      time_.tell(time, path_, [&](uint64_t high) { put_high(high); });
      put_little(bytes_, (event.polarity > 0 ? evt::kOn : evt::kOff) << 28 | static_cast<uint32_t>(time & 63) << 22 |
                             uint32_t{event.x} << 11 | uint32_t{event.y});
    }
  }
  void put_high(uint64_t high) { put_little(bytes_, evt::kTimeHigh2 << 28 | static_cast<uint32_t>(high)); }

  Evt2Time time_;
};

class Evt21Writer : public RawWriter {
 public:
  explicit Evt21Writer(const EventFilePlan& plan) : RawWriter(plan, "EVT21;endianness=little", "2.1") { put_high(0); }

 private:
  void put_row(std::span<const Event> row) override {
    while (!row.empty()) {
      const Event& first = row.front();
      const uint64_t time = ticks(first);
      time_.tell(time, path_, [&](uint64_t high) { put_high(high); });
      const unsigned base = first.x / evt::kVector * evt::kVector;
      uint64_t valid = 0;
      const std::span<const Event> vector = before(row, base + evt::kVector);
      for (const Event& event : vector) valid |= uint64_t{1} << (event.x - base);
      put_little(bytes_, uint64_t{first.polarity > 0 ? evt::kOn : evt::kOff} << 60 | (time & 63) << 54 |
                             uint64_t{base} << 43 | uint64_t{first.y} << 32 | valid);
      row = row.subspan(vector.size());
    }
  }
  void put_high(uint64_t high) { put_little(bytes_, uint64_t{evt::kTimeHigh2} << 60 | high << 32); }

  Evt2Time time_;
};

class Evt3Writer : public RawWriter {
 public:
  explicit Evt3Writer(const EventFilePlan& plan) : RawWriter(plan, "EVT3", "3.0") { put(evt::kTimeHigh3, 0); }

 private:
  void put_row(std::span<const Event> row) override {
    tell_time(ticks(row.front()));
    if (row.front().y != y_ || !told_) put(evt::kAddrY, row.front().y);
    y_ = row.front().y;
    told_ = true;
    while (!row.empty()) {
      const unsigned base = row.front().x;
      const uint64_t on = row.front().polarity > 0 ? 1u << 11 : 0;
      const std::span<const Event> vector = before(row, base + evt::kVector);
      constexpr size_t kWorthIt = 4;  // a vector takes four words
      if (vector.size() >= kWorthIt) {
        uint64_t valid = 0;
        for (const Event& event : vector) valid |= uint64_t{1} << (event.x - base);
        put(evt::kVectBase, base | on);
        put(evt::kVect12, valid & 0xfff);
        put(evt::kVect12, valid >> 12 & 0xfff);
        put(evt::kVect8, valid >> 24);
      } else {
        for (const Event& event : vector) put(evt::kAddrX, event.x | on);
      }
      row = row.subspan(vector.size());
    }
  }

  void tell_time(uint64_t time) {
    const uint64_t high = time >> evt::kTimeBits3, low = time & 0xfff;
    bool tell_low = low != low_ || !told_;
    // Readers count the turns of this 12-bit counter: each of its values has to be there, however long nothing fires.
    while (high_ != high) {
      put(evt::kTimeHigh3, ++high_ & 0xfff);
      tell_low = true;
    }
    if (tell_low) put(evt::kTimeLow, low);
    low_ = low;
  }
  void put(uint16_t type, uint64_t payload) { put_little(bytes_, static_cast<uint16_t>(type << 12 | payload)); }

  uint64_t high_ = 0, low_ = 0;
  uint16_t y_ = 0;
  bool told_ = false;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_raw_writer(const EventFilePlan& plan) {
  switch (plan.options.evt) {
    case EventFileOptions::Evt::evt2:
      return std::make_unique<Evt2Writer>(plan);
    case EventFileOptions::Evt::evt21:
      return std::make_unique<Evt21Writer>(plan);
    case EventFileOptions::Evt::evt3:
      break;
  }
  return std::make_unique<Evt3Writer>(plan);
}

}  // namespace kairos
