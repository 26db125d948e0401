#include "events/event_film.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kairos {

namespace {

/// Of a threshold: by how much straight lines between the instants that are looked at may be off.
constexpr double kChordShare = 1.0 / 50;

}  // namespace

EventFilm::EventFilm(const Shot& shot, const LightClock& clock, const EventOptions& options, const EventPixels& sensor,
                     PixelStates& states)
    : options_(options), clock_(clock), edges_(shot), sensor_(sensor), states_(states) {
  needs_.time = RecordNeeds::Time::segments;
  needs_.contrast = static_cast<float>(kChordShare * std::min(options.sensor.on, options.sensor.off));
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
  std::vector<Event> events;
  sensor_.see(states_.at(record.x, record.y), record.x, record.y, light, events);
  const std::lock_guard<std::mutex> lock(mutex_);
  events_.insert(events_.end(), events.begin(), events.end());
  scratch_.push_back(std::move(scratch));
}

std::vector<Event> EventFilm::take() {
  std::sort(events_.begin(), events_.end());
  return std::exchange(events_, {});
}

LightCounts EventFilm::counts() const {
  LightCounts sum;
  for (const auto& scratch : scratch_) sum.add(scratch->counts());
  return sum;
}

}  // namespace kairos
