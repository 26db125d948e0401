// kairos events info: what a file of events holds.
#include <algorithm>
#include <limits>
#include <memory>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include <kairos/event_file.h>

#include "arguments.h"
#include "events_commands.h"

namespace kairos::cli {

namespace {

/// Counts as it reads: files may be larger than memory would hold as events.
class Tally : public EventSink {
 public:
  void add(std::span<const Event> events) override {
    for (const Event& event : events) {
      ++(event.polarity > 0 ? on : off);
      noise += event.kind != EventKind::signal;
      if (event.time < last) ++backwards;
      first = std::min(first, event.time);
      last = std::max(last, event.time);
      width = std::max(width, int{event.x} + 1);
      height = std::max(height, int{event.y} + 1);
      const int64_t stamp = event.time / 1000;
      same = stamp == stamp_ ? same + 1 : 1;
      stamp_ = stamp;
      busiest = std::max(busiest, same);
      const size_t pixel = size_t{event.y} * 65536 + event.x;
      ++pixels[pixel];
    }
  }
  uint64_t count() const { return on + off; }
  double seconds() const { return count() > 0 ? static_cast<double>(last - first) * 1e-9 : 0; }

  uint64_t on = 0, off = 0, noise = 0, backwards = 0, busiest = 0, same = 0;
  int64_t first = std::numeric_limits<int64_t>::max(), last = std::numeric_limits<int64_t>::min();
  int width = 0, height = 0;
  std::unordered_map<size_t, uint64_t> pixels;

 private:
  int64_t stamp_ = -1;
};

void run_info(const std::string& path, bool as_json) {
  Tally tally;
  const EventFileFacts facts = read_events(path, tally);
  const uint64_t count = tally.count();
  uint64_t hottest = 0;
  for (const auto& [pixel, events] : tally.pixels) hottest = std::max(hottest, events);
  const double rate = tally.seconds() > 0 ? static_cast<double>(count) / tally.seconds() : 0;
  const double first = count > 0 ? static_cast<double>(tally.first) * 1e-9 : 0,
               last = count > 0 ? static_cast<double>(tally.last) * 1e-9 : 0;
  if (as_json) {
    nlohmann::ordered_json json;
    json["format"] = facts.format;
    json["width"] = facts.width;
    json["height"] = facts.height;
    json["events"] = count;
    json["on"] = tally.on;
    json["off"] = tally.off;
    json["noise"] = tally.noise;
    json["first_s"] = first;
    json["last_s"] = last;
    json["events_per_s"] = rate;
    json["pixels_that_fire"] = tally.pixels.size();
    json["events_of_the_busiest_pixel"] = hottest;
    json["events_of_the_busiest_microsecond"] = tally.busiest;
    json["backwards"] = tally.backwards;
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{}, {}\n", facts.format,
             facts.width > 0
                 ? fmt::format("{}x{} pixels", facts.width, facts.height)
                 : fmt::format("does not say how many pixels; the events lie in {}x{}", tally.width, tally.height));
  fmt::print("{} events: {} on, {} off{}\n", count, tally.on, tally.off,
             tally.noise > 0 ? fmt::format("; {} are noise", tally.noise) : "");
  if (count == 0) return;
  fmt::print("from {:.9f} to {:.9f} s, {:.4g} a second\n", first, last, rate);
  fmt::print("{} pixels fire, the busiest {} times; {} events have the busiest microsecond\n", tally.pixels.size(),
             hottest, tally.busiest);
  if (tally.backwards > 0) fmt::print("warning: {} events are earlier than one before them\n", tally.backwards);
}

}  // namespace

void add_events_info_command(CLI::App& events, Action& chosen) {
  CLI::App& command = *events.add_subcommand("info", "Say what a file of events holds");
  struct Arguments {
    std::string path;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("FILE", arguments->path, "A file of events")->required();
  command.add_flag("--json", arguments->json, "As JSON");
  command.callback([arguments, &chosen] { chosen = [arguments] { run_info(arguments->path, arguments->json); }; });
}

}  // namespace kairos::cli
