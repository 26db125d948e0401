// What an event camera's pixel makes of the light that it gets: crossings of its thresholds, and its faults.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <kairos/events.h>

#include "events/pixel_intensity.h"

namespace kairos {

/// What a pixel carries along from piece to piece.
struct PixelState {
  double level = 0;                                               ///< logarithm at which it fired last
  double since = 0;                                               ///< seconds: from when on the level leaks
  double signal = 0;                                              ///< of the photoreceptor, where that is slow
  double blind_until = -std::numeric_limits<double>::infinity();  ///< seconds
  double next_shot = std::numeric_limits<double>::infinity();     ///< seconds: when noise may strike
  int64_t last = std::numeric_limits<int64_t>::min();             ///< nanoseconds: of the last event
  uint32_t fired = 0, shots = 0;                                  ///< ordinals of random numbers
  bool started = false, stale = false;                            ///< stale: takes a new level when it sees again
};

/// The same for all pixels; from any number of threads, of one pixel from one. Random numbers are hashes of seed, pixel
/// and ordinal, so that nothing depends on how time is cut. docs/events.md, "The sensor".
class EventPixels {
 public:
  EventPixels(const EventSensor& sensor, uint64_t seed);

  /// Which part of red, green and blue pixel (x, y) gets.
  Vec3f channels(int x, int y) const;

  /// Light that follows on what the pixel has seen. Appends its events in order of time.
  void see(PixelState& pixel, int x, int y, std::span<const LightPiece> light, std::vector<Event>& events) const;

 private:
  /// One pixel's own values.
  struct Traits {
    uint64_t key;
    double on, off;
    double fall;  // of the level, by leaking, per second
  };
  Traits traits(int x, int y) const;
  double leak_of(const Traits& traits, const PixelState& pixel) const;
  double brightness(double light) const { return light * scale_ + sensor_.dark; }
  void start(PixelState& pixel, const Traits& traits, const LightPiece& first) const;
  void wait_for_shot(PixelState& pixel, const Traits& traits, double from) const;
  /// Takes the pixel through a run (event_pixel.cpp): a stretch of the signal in closed form.
  template <class Run>
  void follow(PixelState& pixel, const Traits& traits, Run run, int x, int y, std::vector<Event>& events) const;
  void low_pass(PixelState& pixel, const Traits& traits, const LightPiece& piece, int x, int y,
                std::vector<Event>& events) const;

  EventSensor sensor_;
  uint64_t seed_;
  double scale_;
};

}  // namespace kairos
