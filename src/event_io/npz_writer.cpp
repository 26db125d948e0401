// numpy archives of events: a ZIP file whose members are arrays.
#include <array>
#include <bit>
#include <optional>
#include <utility>

#include "base/atomic_file.h"
#include "event_io/crc32.h"
#include "event_io/event_format.h"
#include "event_io/npy.h"
#include "event_io/scratch_file.h"

namespace kairos {

namespace {

constexpr uint32_t kNoSize = 0xffffffffu;  // of 32 bits: the real one stands in the ZIP64 fields
constexpr uint16_t kZip64 = 1, kVersion = 45, kStored = 0;
constexpr uint16_t kFirstDay = 0x21;  // 1 January 1980, the earliest there is: files of the same events are the same

/// A ZIP archive that is written member by member, nothing compressed. All have 64-bit sizes.
class ZipWriter {
 public:
  explicit ZipWriter(const std::string& path) : file_(path) {}

  /// body: writes the `size` bytes of which crc is the checksum.
  template <class Body>
  void add(const std::string& name, uint64_t size, uint32_t crc, const Body& body) {
    const uint64_t offset = file_.tell();
    bytes_.clear();
    put_little(bytes_, uint32_t{0x04034b50});
    put_common(name, crc, 20);
    put_name(name);
    put_sizes(size, nullptr);
    write();
    body(file_);
    members_.push_back({name, size, offset, crc});
  }

  void finish() {
    const uint64_t directory = file_.tell();
    for (const Member& member : members_) {
      bytes_.clear();
      put_little(bytes_, uint32_t{0x02014b50});
      put_little(bytes_, kVersion);
      put_common(member.name, member.crc, 28);
      for (int i = 0; i < 3; ++i) put_little(bytes_, uint16_t{0});  // comment, disk, internal attributes
      put_little(bytes_, uint32_t{0});                              // external attributes
      put_little(bytes_, kNoSize);                                  // where it lies
      put_name(member.name);
      put_sizes(member.size, &member.offset);
      write();
    }
    const uint64_t end = file_.tell();
    bytes_.clear();
    put_little(bytes_, uint32_t{0x06064b50});
    put_little(bytes_, uint64_t{44});  // bytes that follow
    put_little(bytes_, kVersion);
    put_little(bytes_, kVersion);
    put_little(bytes_, uint64_t{0});  // disks
    put_little(bytes_, uint64_t{members_.size()});
    put_little(bytes_, uint64_t{members_.size()});
    put_little(bytes_, end - directory);
    put_little(bytes_, directory);
    put_little(bytes_, uint32_t{0x07064b50});
    put_little(bytes_, uint32_t{0});
    put_little(bytes_, end);
    put_little(bytes_, uint32_t{1});
    put_little(bytes_, uint32_t{0x06054b50});
    put_little(bytes_, uint32_t{0});
    put_little(bytes_, static_cast<uint16_t>(members_.size()));
    put_little(bytes_, static_cast<uint16_t>(members_.size()));
    put_little(bytes_, kNoSize);
    put_little(bytes_, kNoSize);
    put_little(bytes_, uint16_t{0});
    write();
    file_.commit();
  }

 private:
  struct Member {
    std::string name;
    uint64_t size, offset;
    uint32_t crc;
  };

  void put_common(const std::string& name, uint32_t crc, uint16_t extra) {
    for (const uint16_t value : {kVersion, uint16_t{0}, kStored, uint16_t{0}, kFirstDay}) put_little(bytes_, value);
    put_little(bytes_, crc);
    put_little(bytes_, kNoSize);
    put_little(bytes_, kNoSize);
    put_little(bytes_, static_cast<uint16_t>(name.size()));
    put_little(bytes_, extra);
  }
  void put_name(const std::string& name) { bytes_.insert(bytes_.end(), name.begin(), name.end()); }
  void put_sizes(uint64_t size, const uint64_t* offset) {
    put_little(bytes_, kZip64);
    put_little(bytes_, static_cast<uint16_t>(offset != nullptr ? 24 : 16));
    put_little(bytes_, size);
    put_little(bytes_, size);
    if (offset != nullptr) put_little(bytes_, *offset);
  }
  void write() { file_.write(bytes_.data(), bytes_.size()); }

  AtomicFile file_;
  std::vector<Member> members_;
  std::vector<uint8_t> bytes_;
};

/// An array whose length is known when it is complete.
class Column {
 public:
  Column(const std::string& path, std::string name, std::string descr)
      : file_(path), name_(std::move(name)), descr_(std::move(descr)) {}

  template <class Value>
  void put(Value value) {
    put_little(bytes_, value);
  }
  void flush() {
    file_.write(bytes_.data(), bytes_.size());
    size_ += bytes_.size();
    bytes_.clear();
  }
  /// The checksum begins with the header, which is known last: what follows is read once more for it.
  void add_to(ZipWriter& zip) {
    const std::string header = npy_header(descr_, size_ / npy_item_size(descr_));
    Crc32 crc;
    crc.add(header.data(), header.size());
    file_.read([&](const char* block, size_t size) { crc.add(block, size); });
    zip.add(name_ + ".npy", kNpyHeader + size_, crc.value(), [&](AtomicFile& out) {
      out.write(header.data(), header.size());
      file_.read([&](const char* block, size_t size) { out.write(block, size); });
    });
  }

 private:
  ScratchFile file_;
  std::string name_, descr_;
  std::vector<uint8_t> bytes_;
  uint64_t size_ = 0;
};

/// What made pixels fire.
struct LabelColumns {
  Column surface, behind, depth, flow_x, flow_y, edge;

  explicit LabelColumns(const std::string& path)
      : surface(path, "surface", "'<u4'"),
        behind(path, "behind", "'<u4'"),
        depth(path, "depth", "'<f4'"),
        flow_x(path, "flow_x", "'<f4'"),
        flow_y(path, "flow_y", "'<f4'"),
        edge(path, "edge", "'|b1'") {}
  void put(const EventLabel& label) {
    surface.put(label.surface);
    behind.put(label.behind);
    depth.put(std::bit_cast<uint32_t>(label.depth));
    flow_x.put(std::bit_cast<uint32_t>(label.flow[0]));
    flow_y.put(std::bit_cast<uint32_t>(label.flow[1]));
    edge.put(static_cast<uint8_t>(label.edge));
  }
  std::array<Column*, 6> all() { return {&surface, &behind, &depth, &flow_x, &flow_y, &edge}; }
};

class NpzWriter : public EventFileWriter::Format {
 public:
  explicit NpzWriter(const EventFilePlan& plan)
      : plan_(plan),
        zip_(plan.path),
        nanoseconds_(plan.options.time == EventFileOptions::Time::nanoseconds),
        off_(plan.options.polarity == EventFileOptions::Polarity::zero_one ? 0 : -1),
        t_(plan.path, "t", "'<i8'"),
        x_(plan.path, "x", "'<u2'"),
        y_(plan.path, "y", "'<u2'"),
        p_(plan.path, "p", "'|i1'") {
    if (plan.options.kinds) kind_.emplace(plan.path, "kind", "'|u1'");
    if (plan.options.labels) labels_.emplace(plan.path);
  }

  void add(std::span<const Event> events) override { add_labelled(events, {}); }
  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override {
    if (labels_)
      for (size_t i = 0; i < events.size(); ++i) labels_->put(i < labels.size() ? labels[i] : EventLabel{});
    for (const Event& event : events) {
      t_.put(nanoseconds_ ? event.time : microseconds(event.time));
      x_.put(event.x);
      y_.put(event.y);
      p_.put(event.polarity > 0 ? int8_t{1} : off_);
      if (kind_) kind_->put(static_cast<uint8_t>(event.kind));
    }
    for (Column* column : columns()) column->flush();
  }

  void finish() override {
    for (Column* column : columns()) column->add_to(zip_);
    Column resolution(plan_.path, "resolution", "'<i4'"), tick(plan_.path, "ns_per_tick", "'<i8'");
    resolution.put(static_cast<int32_t>(plan_.width));
    resolution.put(static_cast<int32_t>(plan_.height));
    tick.put(int64_t{nanoseconds_ ? 1 : 1000});
    for (Column* column : {&resolution, &tick}) {
      column->flush();
      column->add_to(zip_);
    }
    zip_.finish();
  }

 private:
  std::vector<Column*> columns() {
    std::vector<Column*> all{&t_, &x_, &y_, &p_};
    if (kind_) all.push_back(&*kind_);
    if (labels_)
      for (Column* column : labels_->all()) all.push_back(column);
    return all;
  }

  EventFilePlan plan_;
  ZipWriter zip_;
  bool nanoseconds_;
  int8_t off_;
  Column t_, x_, y_, p_;
  std::optional<Column> kind_;
  std::optional<LabelColumns> labels_;
};

/// One array of events as Metavision has them, which can be mapped into memory.
class NpyWriter : public EventFileWriter::Format {
 public:
  explicit NpyWriter(const EventFilePlan& plan) : file_(plan.path) { write_header(); }

  void add(std::span<const Event> events) override {
    bytes_.clear();
    for (const Event& event : events) {
      put_little(bytes_, event.x);
      put_little(bytes_, event.y);
      put_little(bytes_, int16_t{event.polarity > 0});
      put_little(bytes_, uint16_t{0});
      put_little(bytes_, microseconds(event.time));
    }
    file_.write(bytes_.data(), bytes_.size());
    count_ += events.size();
  }
  void finish() override {
    file_.seek(0);
    write_header();
    file_.commit();
  }

 private:
  void write_header() {
    const std::string header = npy_header(kNpyEvents, count_);
    file_.write(header.data(), header.size());
  }

  AtomicFile file_;
  std::vector<uint8_t> bytes_;
  uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_npz_writer(const EventFilePlan& plan) {
  return std::make_unique<NpzWriter>(plan);
}
std::unique_ptr<EventFileWriter::Format> make_npy_writer(const EventFilePlan& plan) {
  return std::make_unique<NpyWriter>(plan);
}

}  // namespace kairos
