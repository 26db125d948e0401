// Files of iniVation's sensors: AEDAT4 as dv writes it, and AEDAT-2.0 of jAER.
#include <array>
#include <string_view>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "event_io/event_format.h"

namespace kairos {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_input, path, why);
}

constexpr std::string_view kMagic4 = "#!AER-DAT4.0\r\n";
constexpr size_t kTablePlace = 46;  // where the header says where the table of packets lies
constexpr size_t kMostInPacket = 4096;

void put_words(std::vector<uint8_t>& out, std::initializer_list<uint16_t> words) {
  for (const uint16_t word : words) put_little(out, word);
}
void put_text(std::vector<uint8_t>& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

std::string aedat4_description(int width, int height) {
  const auto attr = [](const std::string& key, const std::string& type, const std::string& value) {
    return "<attr key=\"" + key + "\" type=\"" + type + "\">" + value + "</attr>";
  };
  return "<dv version=\"2.0\"><node name=\"outInfo\" path=\"/mainloop/Recorder/outInfo/\">"
         "<node name=\"0\" path=\"/mainloop/Recorder/outInfo/0/\">" +
         attr("compression", "string", "NONE") + attr("originalModuleName", "string", "kairos") +
         attr("originalOutputName", "string", "events") +
         attr("typeDescription", "string", "Array of events (polarity ON/OFF).") +
         attr("typeIdentifier", "string", "EVTS") + "<node name=\"info\" path=\"/mainloop/Recorder/outInfo/0/info/\">" +
         attr("sizeX", "int", std::to_string(width)) + attr("sizeY", "int", std::to_string(height)) +
         attr("source", "string", "Kairos") + "</node></node></node></dv>";
}

/// Every part of it is a flatbuffer of a fixed layout, with its size before it; nothing is compressed.
class Aedat4Writer : public EventFileWriter::Format {
 public:
  explicit Aedat4Writer(const EventFilePlan& plan) : file_(plan.path) {
    const std::string text = aedat4_description(plan.width, plan.height);
    std::vector<uint8_t> header;  // from the field of its size on
    put_little(header, uint32_t{0});
    put_little(header, uint32_t{20});
    put_text(header, "IOHE");
    put_words(header, {10, 20, 4, 8, 16, 0});
    put_little(header, int32_t{12});
    put_little(header, int32_t{0});   // not compressed
    put_little(header, int64_t{-1});  // the table: not yet there
    put_little(header, uint32_t{4});
    put_little(header, static_cast<uint32_t>(text.size()));
    put_text(header, text);
    header.push_back(0);
    while (header.size() % 8 != 0) header.push_back(0);
    const auto size = static_cast<uint32_t>(header.size() - 4);
    for (size_t i = 0; i < 4; ++i) header[i] = static_cast<uint8_t>(size >> (8 * i));
    file_.write(kMagic4.data(), kMagic4.size());
    file_.write(header.data(), header.size());
  }

  void add(std::span<const Event> events) override {
    for (; !events.empty(); events = events.subspan(std::min(kMostInPacket, events.size())))
      add_packet(events.first(std::min(kMostInPacket, events.size())));
  }

  void finish() override {
    const size_t table = file_.tell();
    bytes_.clear();
    const auto count = static_cast<uint32_t>(packets_.size());
    put_little(bytes_, uint32_t{0});
    put_little(bytes_, uint32_t{16});
    put_text(bytes_, "FTAB");
    put_words(bytes_, {6, 8, 4, 0});
    put_little(bytes_, int32_t{8});
    put_little(bytes_, uint32_t{4});
    put_little(bytes_, count);
    const size_t offsets = bytes_.size();
    bytes_.resize(offsets + size_t{4} * count);
    while (bytes_.size() % 8 != 0) bytes_.push_back(0);
    const size_t layout = bytes_.size();
    put_words(bytes_, {14, 48, 8, 16, 24, 32, 40, 0});
    for (uint32_t i = 0; i < count; ++i) {
      const size_t at = bytes_.size(), offset = offsets + size_t{4} * i;
      for (size_t byte = 0; byte < 4; ++byte) bytes_[offset + byte] = static_cast<uint8_t>((at - offset) >> (8 * byte));
      const Packet& packet = packets_[i];
      put_little(bytes_, static_cast<int32_t>(at - layout));
      put_little(bytes_, int32_t{0});
      put_little(bytes_, packet.position);
      put_little(bytes_, int32_t{0});  // of stream 0
      put_little(bytes_, packet.size);
      for (const int64_t value : {packet.events, packet.first, packet.last}) put_little(bytes_, value);
    }
    const auto size = static_cast<uint32_t>(bytes_.size() - 4);
    for (size_t i = 0; i < 4; ++i) bytes_[i] = static_cast<uint8_t>(size >> (8 * i));
    file_.write(bytes_.data(), bytes_.size());
    bytes_.clear();
    put_little(bytes_, static_cast<int64_t>(table));
    file_.seek(kTablePlace);
    file_.write(bytes_.data(), bytes_.size());
    file_.commit();
  }

 private:
  struct Packet {
    int64_t position;
    int32_t size;
    int64_t events, first, last;
  };

  void add_packet(std::span<const Event> events) {
    const auto count = static_cast<uint32_t>(events.size());
    const uint32_t size = 28 + 16 * count;
    bytes_.clear();
    put_little(bytes_, int32_t{0});
    put_little(bytes_, static_cast<int32_t>(size + 4));
    put_little(bytes_, size);
    put_little(bytes_, uint32_t{16});
    put_text(bytes_, "EVTS");
    put_words(bytes_, {6, 8, 4, 0});
    put_little(bytes_, int32_t{8});
    put_little(bytes_, uint32_t{4});
    put_little(bytes_, count);
    for (const Event& event : events) {
      put_little(bytes_, microseconds(event.time));
      put_little(bytes_, event.x);
      put_little(bytes_, event.y);
      put_little(bytes_, uint32_t{event.polarity > 0});
    }
    packets_.push_back({static_cast<int64_t>(file_.tell()) + 8, static_cast<int32_t>(size + 4), int64_t{count},
                        microseconds(events.front().time), microseconds(events.back().time)});
    file_.write(bytes_.data(), bytes_.size());
  }

  AtomicFile file_;
  std::vector<Packet> packets_;
  std::vector<uint8_t> bytes_;
};

/// jAER's addresses of the sensors that it knows the sizes of.
struct Aedat2Sensor {
  int width, height;
  const char* chip;
  int x_shift, y_shift, p_shift;
};
constexpr std::array<Aedat2Sensor, 3> kAedat2Sensors{{
    {240, 180, "eu.seebetter.ini.chips.davis.DAVIS240C", 12, 22, 11},
    {346, 260, "eu.seebetter.ini.chips.davis.Davis346blue", 12, 22, 11},
    {640, 480, "eu.seebetter.ini.chips.davis.Davis640", 1, 11, 0},
}};

class Aedat2Writer : public EventFileWriter::Format {
 public:
  explicit Aedat2Writer(const EventFilePlan& plan) : path_(plan.path), file_(plan.path) {
    for (const Aedat2Sensor& sensor : kAedat2Sensors)
      if (sensor.width == plan.width && sensor.height == plan.height) sensor_ = &sensor;
    if (sensor_ == nullptr)
      throw Error(ErrorCode::bad_usage, plan.path,
                  "AEDAT-2.0 has addresses for sensors of 240x180, 346x260 and 640x480 pixels alone; give one of these "
                  "with --size, or write .aedat4");
    const std::string header = "#!AER-DAT2.0\r\n# AEChip: " + std::string(sensor_->chip) +
                               "\r\n# Creation time: System.currentTimeMillis() 0\r\n";
    file_.write(header.data(), header.size());
  }
  void add(std::span<const Event> events) override {
    bytes_.clear();
    for (const Event& event : events) {
      const int64_t time = microseconds(event.time);
      if (time > 0x7fffffff)
        throw Error(ErrorCode::bad_usage, path_, "AEDAT-2.0 has no times beyond 35 minutes; write .aedat4");
      const uint32_t x = static_cast<uint32_t>(sensor_->width - 1 - event.x),
                     y = static_cast<uint32_t>(sensor_->height - 1 - event.y);
      const uint32_t address =
          x << sensor_->x_shift | y << sensor_->y_shift | (event.polarity > 0 ? 1u : 0u) << sensor_->p_shift;
      // Readers take a first byte of '#' for one more line of the header.
      if (!begun_ && address >> 24 == '#') continue;
      begun_ = true;
      for (const uint32_t value : {address, static_cast<uint32_t>(time)})
        for (int shift = 24; shift >= 0; shift -= 8) bytes_.push_back(static_cast<uint8_t>(value >> shift));
    }
    file_.write(bytes_.data(), bytes_.size());
  }
  void finish() override { file_.commit(); }

 private:
  std::string path_;
  AtomicFile file_;
  const Aedat2Sensor* sensor_ = nullptr;
  bool begun_ = false;
  std::vector<uint8_t> bytes_;
};

/// The number in an attribute of the header's text; 0 where there is none.
int attribute(std::string_view text, std::string_view key) {
  const size_t at = text.find("key=\"" + std::string(key) + "\"");
  if (at == std::string_view::npos) return 0;
  int value = 0;
  for (size_t i = text.find('>', at); i != std::string_view::npos && i + 1 < text.size() && value < 65536; ++i) {
    const char c = text[i + 1];
    if (c < '0' || c > '9') break;
    value = value * 10 + (c - '0');
  }
  return value <= 65536 ? value : 0;
}

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_aedat4_writer(const EventFilePlan& plan) {
  return std::make_unique<Aedat4Writer>(plan);
}
std::unique_ptr<EventFileWriter::Format> make_aedat2_writer(const EventFilePlan& plan) {
  return std::make_unique<Aedat2Writer>(plan);
}

EventFileFacts read_aedat4(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  constexpr size_t kHeader = 62, kPacket = 8, kInPacket = 32, kEventSize = 16;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kMagic4) || bytes.size() < kHeader) refuse(path, "is no AEDAT4 file");
  const uint64_t size = read_little<uint32_t>(&bytes[14]);
  if (size > bytes.size() - 18) refuse(path, "ends within its header");
  if (text.substr(42, 4) != std::string_view("\0\0\0\0", 4))
    refuse(path, "is compressed, which is not read here; write it without compression");
  const std::string_view header = text.substr(18, size);
  EventFileFacts facts{"AEDAT4", attribute(header, "sizeX"), attribute(header, "sizeY")};
  const auto table = static_cast<int64_t>(read_little<uint64_t>(&bytes[kTablePlace]));
  const uint64_t end = table > 0 ? std::min<uint64_t>(static_cast<uint64_t>(table), bytes.size()) : bytes.size();
  EventBlock block(sink);
  for (uint64_t at = 18 + size; end > at && end - at >= kPacket;) {
    const uint64_t packet_size = read_little<uint32_t>(&bytes[at + 4]);
    if (packet_size > end - at - kPacket) refuse(path, "has a packet that goes beyond its end");
    const uint64_t begin = at + kPacket;
    at = begin + packet_size;
    // Other streams (frames), and layouts that others write: not events as they are written here.
    if (packet_size < kInPacket || text.substr(begin + 8, 4) != "EVTS" ||
        read_little<uint32_t>(&bytes[begin + 4]) != 16)
      continue;
    const uint64_t count = read_little<uint32_t>(&bytes[begin + 28]);
    if (count > (packet_size - kInPacket) / kEventSize) refuse(path, "has a packet with more events than bytes");
    for (uint64_t i = 0; i < count; ++i) {
      const uint8_t* event = &bytes[begin + kInPacket + i * kEventSize];
      const auto time = static_cast<int64_t>(read_little<uint64_t>(event));
      if (time < 0 || time > INT64_MAX / 1000) refuse(path, "has an event at a time that cannot be");
      block.add(time * 1000, read_little<uint16_t>(event + 8), read_little<uint16_t>(event + 10), event[12] != 0);
    }
  }
  block.flush();
  return facts;
}

}  // namespace kairos
