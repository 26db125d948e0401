// numpy archives of events, and arrays of them.
#include <deque>
#include <optional>
#include <type_traits>

#include "base/atomic_file.h"
#include "base/npz_file.h"
#include "event_io/event_format.h"
#include "event_io/label_columns.h"
#include "event_io/npy.h"

namespace kairos {

namespace {

/// What made pixels fire.
class LabelColumns {
 public:
  explicit LabelColumns(const std::string& path) {
    const EventLabel like;
    label_fields(
        [&](const char* name, const auto& field) {
          columns_.emplace_back(path, name, npy_descr<std::remove_cvref_t<decltype(field)>>());
        },
        like);
  }
  void put(const EventLabel& label) {
    auto column = columns_.begin();
    label_fields([&](const char* /*name*/, const auto& field) { put_field(*column++, field); }, label);
  }
  std::deque<NpyColumn>& all() { return columns_; }

 private:
  static void put_field(NpyColumn& column, bool field) { column.put(static_cast<uint8_t>(field)); }
  template <class Number>
  static void put_field(NpyColumn& column, Number field) {
    column.put(field);
  }

  std::deque<NpyColumn> columns_;  // which never move
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
    for (NpyColumn* column : columns()) column->flush();
  }

  void finish() override {
    for (NpyColumn* column : columns()) column->add_to(zip_);
    NpyColumn resolution(plan_.path, "resolution", "'<i4'"), tick(plan_.path, "ns_per_tick", "'<i8'");
    resolution.put(static_cast<int32_t>(plan_.width));
    resolution.put(static_cast<int32_t>(plan_.height));
    tick.put(int64_t{nanoseconds_ ? 1 : 1000});
    resolution.add_to(zip_);
    tick.add_to(zip_);
    zip_.finish();
  }

 private:
  std::vector<NpyColumn*> columns() {
    std::vector<NpyColumn*> all{&t_, &x_, &y_, &p_};
    if (kind_) all.push_back(&*kind_);
    if (labels_)
      for (NpyColumn& column : labels_->all()) all.push_back(&column);
    return all;
  }

  EventFilePlan plan_;
  NpzFile zip_;
  bool nanoseconds_;
  int8_t off_;
  NpyColumn t_, x_, y_, p_;
  std::optional<NpyColumn> kind_;
  std::optional<LabelColumns> labels_;
};

/// One array of events as Metavision has them, which can be mapped into memory.
class NpyWriter : public EventFileWriter::Format {
 public:
  explicit NpyWriter(const EventFilePlan& plan) : file_(plan.path, kNpyEvents) {
    if (plan.options.labels) labels_.emplace(npy_labels_path(plan.path), npy_labels_descr());
  }

  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override {
    add(events);
    if (!labels_) return;
    bytes_.clear();
    for (size_t i = 0; i < events.size(); ++i) {
      const KindLabel all{labels[i], static_cast<uint8_t>(events[i].kind)};
      kind_label_fields(
          [&](const char* /*name*/, const auto& field) {
            if constexpr (std::is_same_v<decltype(field), const bool&>)
              put_item(bytes_, static_cast<uint8_t>(field));
            else
              put_item(bytes_, field);
          },
          all);
    }
    labels_->write(bytes_, events.size());
  }
  void add(std::span<const Event> events) override {
    bytes_.clear();
    for (const Event& event : events) {
      put_little(bytes_, event.x);
      put_little(bytes_, event.y);
      put_little(bytes_, int16_t{event.polarity > 0});
      put_little(bytes_, uint16_t{0});
      put_little(bytes_, microseconds(event.time));
    }
    file_.write(bytes_, events.size());
  }
  void finish() override {
    if (labels_) labels_->finish();
    file_.finish();
  }

 private:
  NpyFile file_;
  std::optional<NpyFile> labels_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_npz_writer(const EventFilePlan& plan) {
  return std::make_unique<NpzWriter>(plan);
}
std::unique_ptr<EventFileWriter::Format> make_npy_writer(const EventFilePlan& plan) {
  return std::make_unique<NpyWriter>(plan);
}

}  // namespace kairos
