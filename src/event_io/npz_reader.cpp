// numpy arrays and archives of events, as written here and by others.
#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>

#include <kairos/error.h>

#include "base/file.h"
#include "event_io/event_format.h"
#include "event_io/npy.h"

namespace kairos {

namespace {

constexpr uint64_t kMostHeader = 65536;  // bytes: of an array's file

[[noreturn]] void refuse_archive(const std::string& place, const std::string& why) {
  throw Error(ErrorCode::bad_input, place, why);
}

/// The members of a ZIP archive, none of them compressed.
std::map<std::string, std::span<const uint8_t>> members_of(const std::string& path, std::span<const uint8_t> bytes) {
  constexpr size_t kEnd = 22, kLocator = 20, kEnd64 = 56, kEntry = 46, kLocal = 30, kMostComment = 65535;
  constexpr uint32_t kSaturated = 0xffffffffu;
  const auto there = [&](uint64_t at, uint64_t size) { return at <= bytes.size() && bytes.size() - at >= size; };
  const auto word = [&](uint64_t at) { return read_little<uint32_t>(&bytes[at]); };
  const auto half = [&](uint64_t at) { return read_little<uint16_t>(&bytes[at]); };
  const auto is = [&](uint64_t at, uint64_t size, uint32_t magic) { return there(at, size) && word(at) == magic; };
  if (bytes.size() < kEnd) refuse_archive(path, "is no numpy archive");
  uint64_t end = bytes.size() - kEnd;
  for (size_t tries = 0; word(end) != 0x06054b50; --end)
    if (end == 0 || ++tries > kMostComment) refuse_archive(path, "is no numpy archive, or not all of one");
  uint64_t count = half(end + 10), at = word(end + 16);
  if (end >= kLocator && is(end - kLocator, kLocator, 0x07064b50)) {
    const auto end64 = read_little<uint64_t>(&bytes[end - kLocator + 8]);
    if (!is(end64, kEnd64, 0x06064b50)) refuse_archive(path, "is an archive with a broken end");
    count = read_little<uint64_t>(&bytes[end64 + 32]);
    at = read_little<uint64_t>(&bytes[end64 + 48]);
  }
  std::map<std::string, std::span<const uint8_t>> members;
  for (uint64_t i = 0; i < count; ++i) {
    if (!is(at, kEntry, 0x02014b50)) refuse_archive(path, "is an archive with a broken directory");
    const uint64_t name_size = half(at + 28), extra_size = half(at + 30), comment_size = half(at + 32);
    if (!there(at + kEntry, name_size + extra_size + comment_size))
      refuse_archive(path, "is an archive with a broken directory");
    const auto place = [&path](const std::string& member) { return std::string(path).append(": ").append(member); };
    const std::string name(reinterpret_cast<const char*>(&bytes[at]) + kEntry, name_size);
    if (half(at + 10) != 0) refuse_archive(place(name), "is compressed; save it with numpy.savez");
    uint64_t size = word(at + 24), offset = word(at + 42);
    const bool long_size = size == kSaturated, long_packed = word(at + 20) == kSaturated,
               long_offset = offset == kSaturated;
    for (uint64_t extra = at + kEntry + name_size, last = extra + extra_size; last - extra >= 4;) {
      const uint64_t length = half(extra + 2);
      if (length > last - extra - 4) refuse_archive(path, "is an archive with a broken directory");
      if (half(extra) == 1) {
        uint64_t field = extra + 4;
        const auto next = [&](uint64_t& value) {
          if (extra + 4 + length - field < 8) refuse_archive(path, "is an archive with a broken directory");
          value = read_little<uint64_t>(&bytes[field]);
          field += 8;
        };
        uint64_t packed = 0;
        if (long_size) next(size);
        if (long_packed) next(packed);
        if (long_offset) next(offset);
      }
      extra += 4 + length;
    }
    if (!is(offset, kLocal, 0x04034b50)) refuse_archive(place(name), "lies beyond the archive's end");
    const uint64_t data = offset + kLocal + half(offset + 26) + half(offset + 28);
    if (!there(data, size)) refuse_archive(place(name), "lies beyond the archive's end");
    members[name] = bytes.subspan(data, size);
    at += kEntry + name_size + extra_size + comment_size;
  }
  return members;
}

/// Numbers of any kind that numpy has.
class Numbers {
 public:
  Numbers(const std::string& place, std::span<const uint8_t> bytes) : array_(parse_npy(place, bytes)) {
    size_ = npy_item_size(array_.descr);
    if (size_ == 0 || size_ > 8) refuse_archive(place, "holds numbers of a kind that events have not: " + array_.descr);
    kind_ = array_.descr[2];
  }

  uint64_t count() const { return array_.count; }
  bool is_real() const { return kind_ == 'f'; }
  double real(uint64_t index) const {
    const uint8_t* at = &array_.data[index * size_];
    if (size_ == 4) return static_cast<double>(std::bit_cast<float>(read_little<uint32_t>(at)));
    return std::bit_cast<double>(read_little<uint64_t>(at));
  }
  int64_t whole(uint64_t index) const {
    if (is_real()) {
      const double value = real(index);
      return std::abs(value) < 0x1p62 ? static_cast<int64_t>(value) : -1;
    }
    const uint8_t* at = &array_.data[index * size_];
    uint64_t value = 0;
    for (size_t i = 0; i < size_; ++i) value |= uint64_t{at[i]} << (8 * i);
    if (kind_ == 'i' && size_ < 8 && (value >> (8 * size_ - 1)) != 0) value |= ~uint64_t{0} << (8 * size_);
    return static_cast<int64_t>(value);
  }

 private:
  NpyArray array_;
  size_t size_;
  char kind_;
};

/// Times that are no whole numbers are seconds. -1 for one that cannot be.
int64_t nanoseconds_of(const Numbers& times, uint64_t index, int64_t ns_per_tick) {
  if (times.is_real()) {
    const double time = times.real(index) * 1e9;
    return time >= 0 && time < 0x1p62 ? std::llround(time) : -1;
  }
  const int64_t ticks = times.whole(index);
  return ticks >= 0 && ticks <= std::numeric_limits<int64_t>::max() / ns_per_tick ? ticks * ns_per_tick : -1;
}

EventKind kind_of(const std::optional<Numbers>& kinds, uint64_t index) {
  if (!kinds || index >= kinds->count()) return EventKind::signal;
  const int64_t kind = kinds->whole(index);
  return kind == 1 ? EventKind::leak : kind == 2 ? EventKind::shot : EventKind::signal;
}

/// What made pixels fire, where an archive says so.
class LabelNumbers {
 public:
  /// find: of an array, by its name. count: of the events.
  template <class Find>
  LabelNumbers(const std::string& path, uint64_t count, const Find& find) {
    const EventLabel like;
    bool all = true;
    label_fields(
        [&](const char* name, const auto& field) {
          const std::optional<Numbers> column = find(name);
          if (!(all = all && column)) return;
          if (column->count() != count) refuse_archive(path, "has labels of another number than its events");
          if (std::is_same_v<decltype(field), const float&> && !column->is_real())
            refuse_archive(path, "has labels of whole numbers where they are real");
          columns_.push_back(*column);
        },
        like);
    if (!all) columns_.clear();
  }

  bool has() const { return !columns_.empty(); }
  EventLabel at(uint64_t index) const {
    EventLabel label;
    auto column = columns_.begin();
    label_fields(
        [&](const char* /*name*/, auto& field) {
          set_field(field, column->is_real() ? column->real(index) : static_cast<double>(column->whole(index)));
          ++column;
        },
        label);
    return label;
  }

 private:
  std::vector<Numbers> columns_;  // in the order of label_fields, or none
};

/// Checks what an event says before it becomes one.
void add_checked(EventBlock& block, const std::string& place, uint64_t index, int64_t nanoseconds, int64_t x, int64_t y,
                 int64_t polarity, EventKind kind) {
  if (nanoseconds < 0 || x < 0 || y < 0 || x > 0xffff || y > 0xffff || polarity < -1 || polarity > 1)
    refuse_archive(place, "event " + std::to_string(index) + " has a time, a place or a polarity that no event has");
  block.add(nanoseconds, static_cast<uint64_t>(x), static_cast<uint64_t>(y), polarity > 0, kind);
}

}  // namespace

EventFileFacts read_npz(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  const auto members = members_of(path, bytes);
  const auto find = [&](const std::string& name) -> std::optional<Numbers> {
    const auto at = members.find(name + ".npy");
    if (at == members.end()) return std::nullopt;
    return Numbers(path + ": " + name, at->second);
  };
  const auto t = find("t"), x = find("x"), y = find("y"), p = find("p");
  if (!t || !x || !y || !p) refuse_archive(path, "is no archive of events: it lacks one of the arrays t, x, y and p");
  if (x->count() != t->count() || y->count() != t->count() || p->count() != t->count())
    refuse_archive(path, "has arrays t, x, y and p of different lengths");
  const auto tick = find("ns_per_tick"), resolution = find("resolution"), kind = find("kind");
  const int64_t ns_per_tick = tick && tick->count() == 1 ? tick->whole(0) : 1000;
  if (ns_per_tick < 1 || ns_per_tick > 1000000000) refuse_archive(path + ": ns_per_tick", "is no unit of time");
  EventFileFacts facts{"npz", 0, 0};
  if (resolution && resolution->count() == 2) {
    facts.width = static_cast<int>(std::clamp<int64_t>(resolution->whole(0), 0, 65535));
    facts.height = static_cast<int>(std::clamp<int64_t>(resolution->whole(1), 0, 65535));
  }
  const LabelNumbers labels(path, t->count(), find);
  EventBlock block(sink);
  for (uint64_t i = 0; i < t->count(); ++i) {
    if (labels.has()) block.label_next(labels.at(i));
    add_checked(block, path, i, nanoseconds_of(*t, i, ns_per_tick), x->whole(i), y->whole(i), p->whole(i),
                kind_of(kind, i));
  }
  block.flush();
  return facts;
}

EventFileFacts read_npy(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  const NpyArray array = parse_npy(path, bytes);
  if (array.descr != kNpyEvents) refuse_archive(path, "is no array of events (x, y, p, t of 16 bytes)");
  std::vector<uint8_t> label_bytes;
  NpyLabels labels;
  if (const std::string beside = npy_labels_path(path); std::filesystem::exists(beside)) {
    label_bytes = read_file(beside, bytes.size() * 2 + kMostHeader);  // a label is longer than an event
    labels = NpyLabels(beside, label_bytes, array.count);
  }
  EventBlock block(sink);
  for (uint64_t i = 0; i < array.count; ++i) {
    EventKind kind = EventKind::signal;
    if (labels.has()) {
      const KindLabel all = labels.at(i);
      block.label_next(all.label);
      kind = all.event_kind();
    }
    const uint8_t* at = &array.data[16 * i];
    const auto time = static_cast<int64_t>(read_little<uint64_t>(at + 8));
    add_checked(block, path, i, time < 0 || time > std::numeric_limits<int64_t>::max() / 1000 ? -1 : time * 1000,
                read_little<uint16_t>(at), read_little<uint16_t>(at + 2),
                static_cast<int16_t>(read_little<uint16_t>(at + 4)), kind);
  }
  block.flush();
  return {"npy", 0, 0};
}

}  // namespace kairos
