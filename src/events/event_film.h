// Events of a stretch of time, made of records.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include <kairos/events.h>
#include <kairos/record.h>

#include "events/event_pixel.h"
#include "events/pixel_intensity.h"

namespace kairos {

/// What all pixels carry along from one stretch of time to the next.
struct PixelStates {
  int width, height;
  std::vector<PixelState> pixels;  // row by row

  PixelStates(int columns, int rows)
      : width(columns), height(rows), pixels(static_cast<size_t>(columns) * static_cast<size_t>(rows)) {}
  PixelState& at(int x, int y) {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

/// Events of a stretch of time, and their labels where they are wanted.
struct EventBatch {
  std::vector<Event> events;
  std::vector<EventLabel> labels;  // [event], or empty

  void append(const EventBatch& more);
  /// Puts them into the stream's order.
  void sort();
  /// Splits off events from `first` on.
  EventBatch split(size_t first);
};

/// Takes records of a shot. Reads all that it is given, which must outlive it.
class EventFilm : public PixelConsumer {
 public:
  EventFilm(const Shot& shot, const LightClock& clock, const EventOptions& options, const EventPixels& sensor,
            PixelStates& states);

  RecordNeeds needs() const override { return needs_; }
  void add(const PixelRecord& record) override;

  /// In no order.
  EventBatch take();
  LightCounts counts() const;

 private:
  std::unique_ptr<PixelIntensity> take_scratch();

  RecordNeeds needs_;
  const EventOptions& options_;
  LightClock clock_;
  EdgeFinder edges_;
  const EventPixels& sensor_;
  PixelStates& states_;
  std::mutex mutex_;  // of what follows
  std::vector<std::unique_ptr<PixelIntensity>> scratch_;
  EventBatch batch_;
};

}  // namespace kairos
