// What integrators hand over: for every ray, what is seen along it, when, and in which colour.
#pragma once

#include <cstdint>
#include <span>

#include <kairos/vec.h>

namespace kairos {

/// A visibility segment, or a part of one, with the colour that it shows. Of a discrete ray: one instant, begin == end.
struct ShadedSegment {
  float begin = 0, end = 0;            ///< shutter time
  float dist_begin = 0, dist_end = 0;  ///< along the ray at both ends, in units of |direction|
  Vec3f colour;                        ///< linear, scene-referred
  Vec3f normal;                        ///< unit, world space; zero where undefined or not asked for
  Vec3f albedo;
  uint32_t mesh = 0, triangle = 0;
  float coverage = 1;  ///< 1 where something is seen; 0 for background that is handed over with a colour of its own
};

/// ShadedSegment::mesh where no mesh is seen.
inline constexpr uint32_t kNoMesh = 0xffffffffu;

struct ShadedRay {
  enum class Kind {
    tc,        ///< the segments' durations say how much of the shutter each one fills
    discrete,  ///< at most one segment, which stands for the whole ray
  };
  Kind kind = Kind::tc;
  std::span<const ShadedSegment> segments;  ///< disjoint, in time order; where there is none, the background is seen
  uint32_t visibility_segments = 0;         ///< of which `segments` may be parts
};

/// Takes the rays of one pixel, in their order. What it makes of them (one colour, deep time, events) is its own
/// affair.
class RaySink {
 public:
  virtual ~RaySink() = default;
  virtual void add(const ShadedRay& ray) = 0;
};

}  // namespace kairos
