// A page on which a person sees a stream of events. docs/events.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <kairos/events.h>
#include <kairos/export.h>

namespace kairos {

/// What was seen from `begin` on, until the next one.
struct EventPagePicture {
  double begin = 0;            ///< seconds, on the events' clock
  std::vector<uint8_t> bytes;  ///< of a PNG file
};

/// Events that a page holds at most: more make it too large for browsers.
inline constexpr size_t kMostPageEvents = 4000000;

/// HTML that needs nothing beside itself: events in red (brighter) and blue (darker) as they come, their rate over
/// time, and the pictures beside. title: the file's name. Throws Error(bad_usage) for no events, or more than
/// kMostPageEvents.
KAIROS_API std::string event_page(std::span<const Event> events, int width, int height, const std::string& title,
                                  std::span<const EventPagePicture> pictures = {});

}  // namespace kairos
