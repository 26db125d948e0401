#include <algorithm>
#include <filesystem>
#include <queue>

#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/event_parts.h>

#include "base/file.h"
#include "event_io/event_notes.h"

namespace kairos {

namespace {

using nlohmann::ordered_json;

constexpr const char* kPart = "part";  // of a part's notes: what is of no concern to who reads a recording's

[[noreturn]] void refuse_part(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_input, path, why + "; remove it, and record this part again");
}

/// A choice that may be left open, as a number; -1: left open.
template <class Choice>
int number_of(const std::optional<Choice>& choice) {
  return choice ? static_cast<int>(*choice) : -1;
}

template <class Choice>
std::optional<Choice> choice_of(const ordered_json& number, Choice last) {
  const int value = number.get<int>();
  if (value < 0) return std::nullopt;
  return static_cast<Choice>(std::min(value, static_cast<int>(last)));
}

ordered_json options_json(const EventFileOptions& options) {
  ordered_json json;
  json["time"] = number_of(options.time);
  json["polarity"] = number_of(options.polarity);
  json["header"] = static_cast<int>(options.header);
  json["evt"] = static_cast<int>(options.evt);
  json["epoch"] = options.epoch;
  json["kinds"] = options.kinds;
  json["labels"] = options.labels;
  json["duration"] = options.duration;
  return json;
}

EventFileOptions parse_options(const ordered_json& json) {
  EventFileOptions options;
  options.time = choice_of(json.at("time"), EventFileOptions::Time::nanoseconds);
  options.polarity = choice_of(json.at("polarity"), EventFileOptions::Polarity::signs);
  options.header = choice_of(json.at("header"), EventFileOptions::Header::v2e).value_or(EventFileOptions::Header::none);
  options.evt = choice_of(json.at("evt"), EventFileOptions::Evt::evt3).value_or(EventFileOptions::Evt::evt3);
  options.epoch = json.at("epoch").get<int64_t>();
  options.kinds = json.at("kinds").get<bool>();
  options.labels = json.at("labels").get<bool>();
  options.duration = json.at("duration").get<int64_t>();
  return options;
}

std::string notes_path(const std::string& part) { return part + ".json"; }

ordered_json read_part_notes(const std::string& part) {
  constexpr uint64_t kMostNotesBytes = 16 << 20;
  const std::vector<uint8_t> bytes = read_file(notes_path(part), kMostNotesBytes);
  ordered_json notes = ordered_json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!notes.is_object() || !notes.contains(kPart) || !notes[kPart].is_object() || !notes[kPart].contains("mark") ||
      !notes[kPart]["mark"].is_string())
    refuse_part(notes_path(part), "is no description of a part of a recording");
  return notes;
}

/// Hands over what all parts hold, in the stream's order.
void hand_over_merged(const std::vector<EventList>& parts, bool labels, EventSink& sink) {
  constexpr size_t kBlock = 1 << 16;
  EventList block;
  const auto flush = [&] {
    if (labels)
      sink.add_labelled(block.events, block.labels);
    else
      sink.add(block.events);
    block.events.clear();
    block.labels.clear();
  };
  struct Next {
    Event event;
    size_t part, index;
    bool operator<(const Next& other) const { return other.event < event; }  // the queue's top is the greatest
  };
  std::priority_queue<Next> next;
  const auto push = [&](size_t part, size_t index) {
    if (index < parts[part].events.size()) next.push({parts[part].events[index], part, index});
  };
  for (size_t part = 0; part < parts.size(); ++part) push(part, 0);
  while (!next.empty()) {
    const Next first = next.top();
    next.pop();
    block.events.push_back(first.event);
    if (labels) block.labels.push_back(parts[first.part].labels[first.index]);
    if (block.events.size() == kBlock) flush();
    push(first.part, first.index + 1);
  }
  flush();
}

/// Adds to a recording's notes what another part counted.
void add_counts(ordered_json& notes, const ordered_json& more) {
  for (const char* name : {"on", "off", "leak", "shot"})
    notes["events"][name] = notes.at("events").at(name).get<uint64_t>() + more.at("events").at(name).get<uint64_t>();
  for (const char* name : {"moving_edges", "steps", "rays_traced", "shading_samples"})
    notes[name] = notes.at(name).get<uint64_t>() + more.at(name).get<uint64_t>();
  notes["cpu_s"] = notes.at("cpu_s").get<double>() + more.at("cpu_s").get<double>();
  constexpr const char* kFastest = "fastest_edge_px_per_s";
  notes[kFastest] = std::max(notes.at(kFastest).get<double>(), more.at(kFastest).get<double>());
}

}  // namespace

EventFileOptions event_part_options(const EventFileOptions& of_recording) {
  EventFileOptions options;
  options.time = EventFileOptions::Time::nanoseconds;
  options.kinds = true;
  options.labels = of_recording.labels;
  options.duration = of_recording.duration;
  return options;
}

void write_event_part_notes(const std::string& path, const EventOptions& options, const EventStats& stats,
                            const std::string& command_line, const EventFileOptions& of_recording,
                            const std::string& mark) {
  ordered_json notes = event_notes(options, stats, command_line);
  notes[kPart]["mark"] = mark;
  notes[kPart]["file"] = options_json(of_recording);
  write_notes(notes_path(path), notes);
}

std::optional<std::string> event_part_mark(const std::string& path) {
  if (!std::filesystem::is_regular_file(path) || !std::filesystem::is_regular_file(notes_path(path)))
    return std::nullopt;
  return read_part_notes(path)[kPart]["mark"].get<std::string>();
}

void merge_event_parts(const std::vector<std::string>& parts, const std::string& out) {
  if (parts.empty()) throw Error(ErrorCode::bad_usage, out, "is to be made of no parts");
  ordered_json notes;
  EventFileOptions options;
  std::vector<EventList> events(parts.size());
  for (size_t i = 0; i < parts.size(); ++i) {
    ordered_json own = read_part_notes(parts[i]);
    try {
      if (i == 0) {
        notes = own;
        options = parse_options(own.at(kPart).at("file"));
      } else if (own[kPart] != notes[kPart]) {
        throw Error(ErrorCode::bad_input, parts[i],
                    "is part of another recording than " + parts.front() +
                        ": scene files, options, kairos or instruction sets were others; remove those that are wrong");
      } else {
        add_counts(notes, own);
      }
    } catch (const ordered_json::exception&) {
      refuse_part(notes_path(parts[i]), "is no description of a part of a recording");
    }
    read_events(parts[i], events[i]);
    if (options.labels && events[i].labels.size() != events[i].events.size()) refuse_part(parts[i], "lacks labels");
    if (!std::is_sorted(events[i].events.begin(), events[i].events.end()))
      refuse_part(parts[i], "has events in another order than that of time");
  }
  int width = 0, height = 0;
  uint64_t count = 0, counted = 0;
  try {
    width = notes.at("width").get<int>();
    height = notes.at("height").get<int>();
    counted = notes.at("events").at("on").get<uint64_t>() + notes.at("events").at("off").get<uint64_t>();
  } catch (const ordered_json::exception&) {
    refuse_part(notes_path(parts.front()), "is no description of a part of a recording");
  }
  for (const EventList& part : events) count += part.events.size();
  if (count != counted)
    throw Error(ErrorCode::bad_input, out,
                "has " + std::to_string(counted) + " events by its parts' descriptions, and " + std::to_string(count) +
                    " in their files; remove the parts, and record them again");
  EventFileWriter file(out, width, height, options);
  hand_over_merged(events, options.labels, file);
  file.finish();
  notes.erase(kPart);
  write_notes(notes_path(out), notes);
}

}  // namespace kairos
