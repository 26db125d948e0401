#include "events/event_film.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace kairos {

namespace {

/// Of a threshold: by how much straight lines between the instants that are looked at may be off.
constexpr double kChordShare = 1.0 / 50;

}  // namespace

void EventBatch::append(const EventBatch& more) {
  events.insert(events.end(), more.events.begin(), more.events.end());
  labels.insert(labels.end(), more.labels.begin(), more.labels.end());
}

void EventBatch::sort() {
  if (labels.empty()) {
    std::sort(events.begin(), events.end());
    return;
  }
  std::vector<std::pair<Event, EventLabel>> pairs(events.size());
  for (size_t i = 0; i < events.size(); ++i) pairs[i] = {events[i], labels[i]};
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 0; i < events.size(); ++i) std::tie(events[i], labels[i]) = pairs[i];
}

EventBatch EventBatch::split(size_t first) {
  EventBatch rest;
  const auto move = [first](auto& from, auto& to) {
    if (from.empty()) return;
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first), from.end());
    from.resize(first);
  };
  move(events, rest.events);
  move(labels, rest.labels);
  return rest;
}

EventFilm::EventFilm(const Shot& shot, const LightClock& clock, const EventOptions& options, const EventPixels& sensor,
                     PixelStates& states)
    : options_(options), clock_(clock), edges_(shot), sensor_(sensor), states_(states) {
  needs_.time = RecordNeeds::Time::segments;
  needs_.contrast = static_cast<float>(kChordShare * std::min(options.sensor.on, options.sensor.off));
  needs_.looks_begin = static_cast<float>(clock.shutter_time(clock.begin));
  needs_.looks_end = static_cast<float>(clock.shutter_time(clock.end));
  needs_.dark = static_cast<float>(options.sensor.dark * options.sensor.white);
}

std::unique_ptr<PixelIntensity> EventFilm::take_scratch() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (scratch_.empty()) {
    const int cells = static_cast<int>(std::lround(std::sqrt(options_.rays)));
    return std::make_unique<PixelIntensity>(edges_, clock_, options_.edges, cells,
                                            options_.sensor.dark * options_.sensor.white);
  }
  auto scratch = std::move(scratch_.back());
  scratch_.pop_back();
  return scratch;
}

void EventFilm::add(const PixelRecord& record) {
  auto scratch = take_scratch();
  const auto light = scratch->make(record, sensor_.channels(record.x, record.y));
  EventBatch own;
  PixelState& state = states_.at(record.x, record.y);
  if (!options_.labels) {
    sensor_.see(state, record.x, record.y, light, own.events);
  } else {
    for (size_t piece = 0; piece < light.size(); ++piece) {
      sensor_.see(state, record.x, record.y, light.subspan(piece, 1), own.events);
      while (own.labels.size() < own.events.size()) {
        const Event& event = own.events[own.labels.size()];
        own.labels.push_back(scratch->label(piece, static_cast<double>(event.time) * 1e-9,
                                            event.kind == EventKind::signal ? event.polarity : 0));
      }
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  batch_.append(own);
  scratch_.push_back(std::move(scratch));
}

EventBatch EventFilm::take() { return std::exchange(batch_, {}); }

LightCounts EventFilm::counts() const {
  LightCounts sum;
  for (const auto& scratch : scratch_) sum.add(scratch->counts());
  return sum;
}

}  // namespace kairos
