// Any bytes as a picture of one format: decoded, all of it there, or a kairos::Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <kairos/error.h>

#include "image/picture_formats.h"

inline void fuzz_picture(const kairos::PictureFormat& format, std::span<const uint8_t> bytes) {
  if (!format.is(bytes)) return;
  try {
    const kairos::PictureCost cost = format.cost(bytes, "fuzz");
    constexpr uint64_t kMostBytes = 1 << 26, kMostSteps = 1 << 22;  // so that inputs are many
    if (cost.bytes > kMostBytes || cost.steps > kMostSteps) return;
    const kairos::Pixels pixels = format.decode(bytes, "fuzz");
    const size_t values = pixels.codes.size() + pixels.values.size() + pixels.wide_codes.size();
    if (values != kairos::texel_count(cost) * kairos::kPictureChannels) __builtin_trap();
    // Memory that was never written would be seen here by MemorySanitizer, and by valgrind.
    volatile uint64_t sum = 0;
    for (const uint8_t code : pixels.codes) sum = sum + code;
    for (const uint16_t code : pixels.wide_codes) sum = sum + code;
  } catch (const kairos::Error&) {
  }
}
