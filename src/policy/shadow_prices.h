// What shadows cost, sampled and exact in time: recorded numbers in place of clocks.
#pragma once

#include <kairos/render.h>
#include <kairos/tracer.h>

#include "policy/ray_prices.h"

namespace kairos {

// Nanoseconds on one thread of an AMD EPYC (Zen 4) with AVX-512, measured by bench/light.py --shadow-prices on the
// scene shade (320x180, median of 5); only their ratios matter.
inline constexpr double kLightRayTime = 141;      ///< of a shading sample to a light, with what it brings
inline constexpr double kRestingLightTime = 450;  ///< of an exact look, but for its time-continuous rays
/// Of a time-continuous ray for which any hit will do, relative to what its counts say of one that looks for the
/// nearest: an exact look takes 613, 844 and 3200 ns on fan, shade and blades, whose counts say 0, 225 and 1169.
inline constexpr double kAnyHitShare = 1.75;

/// Of exact looks, of which the time-continuous rays' counts are known.
inline double exact_look_time(double looks, const TraceCounters& work) {
  return kRestingLightTime * looks + kAnyHitShare * tracing_time(static_cast<double>(work.nodes),
                                                                 static_cast<double>(work.triangles),
                                                                 static_cast<double>(work.hits));
}

/// Of a shading sample of a lit picture, by how many rays it sends to lights.
double lit_sample_time(const Shot& shot, ShadingKind shading);

/// Nanoseconds, beside lit_sample_time(): of weighing each triangle that glows by what it is worth at a point, as is
/// done up to 64 of them (measured: the kitchen, of ten triangles, 3000 in all).
double weighing_time(const Shot& shot);

}  // namespace kairos
