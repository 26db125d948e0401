// How far two streams of events are from each other.
#pragma once

#include <cstdint>
#include <span>

#include <kairos/events.h>
#include <kairos/export.h>

namespace kairos {

/// Events of a pixel and polarity belong to each other in their order, where they are no farther apart than a window;
/// one that has no partner is missing, or one too many.
struct EventDifference {
  uint64_t reference = 0, events = 0;  ///< how many there are
  uint64_t matched = 0;                ///< pairs
  uint64_t missing = 0, extra = 0;     ///< of the reference's, and of the other's, without a partner
  /// Nanoseconds between partners, absolute values; 0 where there are none.
  double median = 0, rms = 0, p95 = 0, most = 0;
  /// How far the brightness that they claim is apart, in thresholds (events that became brighter less those that became
  /// darker): absolute values' mean and root mean square over the time from the first event to the last and over the
  /// pixels that have any.
  double brightness_mean = 0, brightness_rms = 0;
};

/// Both in order of time. window: nanoseconds, above 0.
KAIROS_API EventDifference compare_events(std::span<const Event> reference, std::span<const Event> events,
                                          int64_t window = 10000000);

/// The share of events that have one of the 20 microseconds with the most: near 0, unless stamps come in pillars.
KAIROS_API double pillar_share(std::span<const Event> events);

}  // namespace kairos
