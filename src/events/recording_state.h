// A recording between two chunks, as bytes: whoever has them can go on with it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <kairos/events.h>

#include "events/event_film.h"

namespace kairos {

struct RecordingState {
  int64_t next_chunk = 0;
  PixelStates pixels{0, 0};
  EventBatch late;   ///< events of the chunks before that belong to the next one
  EventStats stats;  ///< so far
};

/// For the same program on a machine of the same kind.
std::vector<uint8_t> recording_bytes(const RecordingState& state);
/// Throws Error(bad_input) for bytes that are none.
RecordingState parse_recording(std::span<const uint8_t> bytes);

}  // namespace kairos
