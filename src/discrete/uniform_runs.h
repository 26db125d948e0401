// Motion keys in pieces that Embree can take: it wants a geometry's time steps evenly spaced.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kairos {

/// Keys `first` to `last` (first < last), evenly spaced in time.
struct UniformRun {
  size_t first = 0, last = 0;
};

/// Embree's RTC_MAX_TIME_STEP_COUNT.
inline constexpr size_t kMaxTimeSteps = 129;

/// Covers ascending key times by as few runs as possible of up to `max_keys` keys each; the span between two equal
/// times (a jump) belongs to none. Within a run no key is farther than a few float roundings from even spacing.
std::vector<UniformRun> uniform_runs(std::span<const float> key_times, size_t max_keys = kMaxTimeSteps);

}  // namespace kairos
