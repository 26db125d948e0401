// Events as lines of text: t x y p.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <string_view>

#include <kairos/error.h>
#include <kairos/version.h>

#include "base/atomic_file.h"
#include "event_io/event_format.h"

namespace kairos {

namespace {

using Header = EventFileOptions::Header;
using Time = EventFileOptions::Time;

/// The first line of a file whose times are nanoseconds: nothing else tells them from microseconds.
constexpr std::string_view kNanoseconds = "# time [ns], x, y, polarity";

class TextWriter : public EventFileWriter::Format {
 public:
  explicit TextWriter(const EventFilePlan& plan)
      : file_(plan.path),
        time_(plan.options.time.value_or(Time::seconds)),
        off_(plan.options.polarity == EventFileOptions::Polarity::signs ? "-1" : "0"),
        flags_(plan.options.header == Header::v2e) {
    if (time_ == Time::nanoseconds) put(std::string(kNanoseconds) + '\n');
    if (plan.options.header == Header::e2vid)
      put(std::to_string(plan.width) + ' ' + std::to_string(plan.height) + '\n');
    if (plan.options.header == Header::v2e)
      put("#!events.txt\n# written by kairos " + std::string(version()) + "\n# size: " + std::to_string(plan.width) +
          'x' + std::to_string(plan.height) + "\n# columns: time [" + (time_ == Time::seconds ? "s" : "us") +
          "], x, y, polarity [1 is brighter], 1 for signal and 0 for noise\n");
  }

  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      char time[48];
      const int64_t whole = event.time / 1000000000, rest = event.time % 1000000000;
      if (time_ == Time::seconds)
        std::snprintf(time, sizeof time, "%lld.%09lld", static_cast<long long>(whole), static_cast<long long>(rest));
      else
        std::snprintf(time, sizeof time, "%lld",
                      static_cast<long long>(time_ == Time::nanoseconds ? event.time : microseconds(event.time)));
      text_ += time;
      text_ += ' ' + std::to_string(event.x) + ' ' + std::to_string(event.y) + ' ' + (event.polarity > 0 ? "1" : off_);
      if (flags_) text_ += event.kind == EventKind::signal ? " 1" : " 0";
      text_ += '\n';
    }
    put(text_);
    text_.clear();
  }
  void finish() override { file_.commit(); }

 private:
  void put(const std::string& text) { file_.write(text.data(), text.size()); }

  AtomicFile file_;
  Time time_;
  std::string off_;
  bool flags_;
  std::string text_;
};

/// One line's words.
class Words {
 public:
  Words(const std::string& place, std::string_view line) : place_(place), rest_(line) {}

  std::string_view next() {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == ','; };
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    const auto end = std::find_if(rest_.begin(), rest_.end(), is_space);
    const std::string_view word = rest_.substr(0, static_cast<size_t>(end - rest_.begin()));
    rest_.remove_prefix(word.size());
    return word;
  }
  int64_t whole(int64_t low, int64_t high) {
    const std::string_view word = next();
    int64_t value = 0;
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || problem != std::errc() || end != word.data() + word.size() || value < low || value > high)
      refuse("'" + std::string(word.substr(0, 40)) + "' is no whole number from " + std::to_string(low) + " to " +
             std::to_string(high));
    return value;
  }
  /// Seconds where there is a point, with what comes behind nine decimals cut off, else ticks.
  int64_t nanoseconds(int64_t ns_per_tick) {
    const std::string_view word = next();
    const size_t point = word.find('.');
    constexpr size_t kMostDigits = 9, kMostWhole = 15, kMostNanoseconds = 18;
    const std::string_view whole = word.substr(0, point);
    std::string digits(whole);
    if (point != std::string_view::npos) digits += word.substr(point + 1, kMostDigits);
    const size_t most = point != std::string_view::npos ? kMostDigits
                        : ns_per_tick == 1              ? kMostNanoseconds
                                                        : kMostWhole;
    if (whole.empty() || whole.size() > most) refuse("'" + std::string(word.substr(0, 40)) + "' is no time");
    int64_t value = 0;
    for (const char digit : digits) {
      if (digit < '0' || digit > '9') refuse("'" + std::string(word.substr(0, 40)) + "' is no time");
      value = value * 10 + (digit - '0');
    }
    const size_t decimals = digits.size() - whole.size();
    if (point == std::string_view::npos) return value * ns_per_tick;
    for (size_t i = decimals; i < kMostDigits; ++i) value *= 10;
    return value;
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::bad_input, place_, why + "; a line is: time x y polarity");
  }

 private:
  std::string place_;
  std::string_view rest_;
};

}  // namespace

std::unique_ptr<EventFileWriter::Format> make_text_writer(const EventFilePlan& plan) {
  return std::make_unique<TextWriter>(plan);
}

EventFileFacts read_event_text(const std::string& path, std::span<const uint8_t> bytes, EventSink& sink) {
  EventFileFacts facts{"text", 0, 0};
  EventBlock block(sink);
  int64_t ns_per_tick = 1000;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (uint64_t number = 1; !text.empty(); ++number) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (number == 1 && line == kNanoseconds) ns_per_tick = 1;
    if (line.empty() || line.front() == '#') continue;
    const std::string place = path + ":" + std::to_string(number);
    if (number == 1 && std::count(line.begin(), line.end(), ' ') == 1) {
      Words words(place, line);
      facts.width = static_cast<int>(words.whole(1, 65536));
      facts.height = static_cast<int>(words.whole(1, 65536));
      continue;
    }
    Words words(place, line);
    const int64_t time = words.nanoseconds(ns_per_tick);
    const auto x = static_cast<uint64_t>(words.whole(0, 65535)), y = static_cast<uint64_t>(words.whole(0, 65535));
    const bool on = words.whole(-1, 1) > 0;
    const bool noise = words.next() == "0";
    block.add(time, x, y, on, noise ? EventKind::shot : EventKind::signal);
  }
  block.flush();
  return facts;
}

}  // namespace kairos
