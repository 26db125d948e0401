// kairos events compare: how far two streams are from each other.
#include <algorithm>
#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include <kairos/event_compare.h>
#include <kairos/event_file.h>

#include "arguments.h"
#include "events_commands.h"

namespace kairos::cli {

namespace {

struct CompareArguments {
  std::string reference, events;
  double window = 0.01;  // seconds
  bool json = false;
};

std::vector<Event> read_all(const std::string& path) {
  EventList all;
  read_events(path, all);
  std::sort(all.events.begin(), all.events.end());
  return all.events;
}

void run_compare(const CompareArguments& arguments) {
  const std::vector<Event> reference = read_all(arguments.reference), events = read_all(arguments.events);
  const EventDifference difference = compare_events(reference, events, std::llround(arguments.window * 1e9));
  const double pillars[] = {pillar_share(reference), pillar_share(events)};
  if (arguments.json) {
    nlohmann::ordered_json json;
    json["reference_events"] = difference.reference;
    json["events"] = difference.events;
    json["matched"] = difference.matched;
    json["missing"] = difference.missing;
    json["extra"] = difference.extra;
    json["median_us"] = difference.median / 1000;
    json["rms_us"] = difference.rms / 1000;
    json["p95_us"] = difference.p95 / 1000;
    json["most_us"] = difference.most / 1000;
    json["brightness_mean_thresholds"] = difference.brightness_mean;
    json["brightness_rms_thresholds"] = difference.brightness_rms;
    json["reference_pillars"] = pillars[0];
    json["pillars"] = pillars[1];
    fmt::print("{}\n", json.dump(2));
    return;
  }
  const auto percent = [&](uint64_t count) {
    return 100 * static_cast<double>(count) / static_cast<double>(std::max<uint64_t>(difference.reference, 1));
  };
  fmt::print(
      "{} events in the reference, {} in the other: {} belong together, {} ({:.2f} %) are missing, {} ({:.2f} %) too "
      "many\n",
      difference.reference, difference.events, difference.matched, difference.missing, percent(difference.missing),
      difference.extra, percent(difference.extra));
  fmt::print("stamps differ by {:.3g} us in the median, {:.3g} us RMS, {:.3g} us in 95 of 100, {:.3g} us at most\n",
             difference.median / 1000, difference.rms / 1000, difference.p95 / 1000, difference.most / 1000);
  fmt::print("the brightness that they claim differs by {:.3g} thresholds in the mean, {:.3g} RMS\n",
             difference.brightness_mean, difference.brightness_rms);
  fmt::print(
      "{:.2f} % of the reference's events, and {:.2f} % of the other's, have one of the 20 busiest microseconds\n",
      100 * pillars[0], 100 * pillars[1]);
}

}  // namespace

void add_events_compare_command(CLI::App& events, Action& chosen) {
  CLI::App& command = *events.add_subcommand("compare", "Say how far a file of events is from another");
  const auto arguments = std::make_shared<CompareArguments>();
  command.add_option("REFERENCE", arguments->reference, "A file of events")->required();
  command.add_option("FILE", arguments->events, "Another one")->required();
  add_real(command, "--window", "Seconds by which partners may be apart [0.01]", "S", [arguments](double value) {
    constexpr double kMost = 1e6;
    if (!(value > 0 && value <= kMost)) throw CLI::ValidationError("--window", "must be above 0 and at most 1e6");
    arguments->window = value;
  });
  command.add_flag("--json", arguments->json, "As JSON");
  command.callback([arguments, &chosen] { chosen = [arguments] { run_compare(*arguments); }; });
}

}  // namespace kairos::cli
