// What a pixel's rays see, when, and in which colours: what integrators hand over, and to whom.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <kairos/export.h>
#include <kairos/tracer.h>

namespace kairos {

/// Segment::mesh where no mesh is seen.
inline constexpr uint32_t kNoMesh = 0xffffffffu;

/// The colour of what is seen at an instant: linear, scene-referred.
struct Knot {
  float time = 0;  ///< shutter time
  Vec3f colour;
};

/// What else a surface says at the instant of a knot.
struct KnotSurface {
  Vec3f normal;  ///< unit, world space; zero where undefined
  Vec3f albedo;
};

/// A visibility segment, or a part of one, with its colours. Between two knots colours go on straight lines; before the
/// first and after the last they stay.
struct SeenPart {
  Segment where;            ///< of a ray of one instant: begin == end; what has the mesh kNoMesh is the sky
  uint32_t first_knot = 0;  ///< index into PixelRecord::knots; parts may share knots
  uint32_t knots = 1;       ///< at least 1, in time order
  uint32_t layer = 0;       ///< how many of the parts right before this one lie in front of it for the same time
  float opacity = 1;        ///< how much of what lies behind it is hidden; below 1 for blended surfaces alone
};

/// A ray of the pixel and what is seen along it.
struct PixelRay {
  Vec2f film;         ///< pixels from the pixel's upper left corner; filters reach beyond the pixel
  float weight = 1;   ///< relative to the pixel's other rays
  float time = kAll;  ///< shutter time of a ray of one instant; NaN: it holds for all of the record's window
  /// Of PixelRecord::parts; in time order, disjoint but for layers; where there is none, the background is seen.
  uint32_t first_part = 0, parts = 0;
  uint32_t visibility_segments = 0;  ///< of which the parts may be parts
  float density = 1;  ///< of a ray of one instant: how densely such rays lie there, relative to evenly over the shutter

  static constexpr float kAll = std::numeric_limits<float>::quiet_NaN();
  bool is_over_time() const { return std::isnan(time); }
};

/// A control variate. What stands still is sampled by more rays than the pixel has: with S the mean over all of them
/// and S' that over the first `own` of them, which lie where the pixel's own rays do, `share` times (S - S') times the
/// integral of the weight of time belongs to the pixel's mean. Its expectation is zero under any weight. See "Static
/// and moving in one pixel" in docs/method.md.
struct StillTerm {
  std::span<const PixelRay> rays;  ///< each of one instant, to what stands still alone; empty: there is no such term
  uint32_t own = 0;
  float share = 0;  ///< of the shutter, about, in which the pixel sees what stands still: found by rays of its own
};

/// How many rays a pixel is given.
struct PixelPlan {
  uint32_t tc_rays = 0;   ///< 0: discrete samples of everything instead
  uint32_t discrete = 0;  ///< samples: at most so many of what stands still beside time-continuous rays, else of all
};

/// All of a pixel. What its spans refer to lives until PixelConsumer::add returns.
struct PixelRecord {
  int x = 0, y = 0;   ///< in the full frame
  bool moves = true;  ///< may anything move in it? Not known of rays of one kind: then true
  PixelPlan plan;     ///< what the integrator meant to take
  TimeRange window;   ///< shutter time in which the pixel is exposed: RenderParams::exposure; its rays know no other
  Vec3f background;   ///< the colour where rays see nothing
  std::span<const PixelRay> rays;
  std::span<const SeenPart> parts;
  std::span<const Knot> knots;
  std::span<const KnotSurface> surfaces;  ///< [knot]; empty unless a consumer needs them
  StillTerm still;

  std::span<const SeenPart> parts_of(const PixelRay& ray) const { return parts.subspan(ray.first_part, ray.parts); }
  std::span<const Knot> knots_of(const SeenPart& part) const { return knots.subspan(part.first_knot, part.knots); }
};

/// What a consumer needs of records. Where several are served by one rendering, the sum of their needs is met: each is
/// handed what it would be handed alone, had it needed as much.
struct RecordNeeds {
  enum class Time {
    box,       ///< the mean over the shutter, every instant counting alike: colours may stand for each other
    curves,    ///< colours at their own instants; where the integrator has a choice, pixels in which anything moves get
               ///< rays over all of the shutter
    segments,  ///< so does every other pixel: all that is seen has exact ends; the integrator qmc refuses
  };
  Time time = Time::box;
  bool normal = false, albedo = false;  ///< KnotSurface's; what nobody needs is zero
  /// Above 0: colours over time are free of noise. Each ray is shaded with the same random numbers at all times, at
  /// least twice in every cell of the grid of shading samples, and as often as it takes for straight
  /// lines to leave no channel farther off than this part of (luminance + dark). What jumps by fifty times as much does
  /// so within 2^-11 of a cell, and what jumps by less within as much more. Only together with Time::segments.
  float contrast = 0;
  float dark = 0;
  /// Shutter times: what is seen before and after is looked at where something else is seen, and no more often.
  float looks_begin = 0, looks_end = 1;

  bool surfaces() const { return normal || albedo; }
  bool over_time() const { return time != Time::box; }
  friend RecordNeeds operator|(const RecordNeeds& a, const RecordNeeds& b) {
    RecordNeeds both = b.contrast > 0 && !(a.contrast > 0 && a.contrast < b.contrast) ? b : a;
    both.time = a.time < b.time ? b.time : a.time;
    both.normal = a.normal || b.normal;
    both.albedo = a.albedo || b.albedo;
    if (a.contrast > 0 && b.contrast > 0) {
      both.looks_begin = std::min(a.looks_begin, b.looks_begin);
      both.looks_end = std::max(a.looks_end, b.looks_end);
    }
    return both;
  }
};

/// Makes something of pixels: a picture, curves in time, events.
class KAIROS_API PixelConsumer {
 public:
  virtual ~PixelConsumer() = default;
  /// Asked once, before the first pixel.
  virtual RecordNeeds needs() const = 0;
  /// Has it this pixel of the frame from before? What all consumers have is not rendered. Called from any thread.
  virtual bool has([[maybe_unused]] int x, [[maybe_unused]] int y) const { return false; }
  /// Called once for every pixel of the crop that is rendered, in no fixed order, for different pixels from different
  /// threads at once; of one pixel, consumers are called one after the other in the order in which they were given.
  /// What it throws ends the rendering.
  virtual void add(const PixelRecord& record) = 0;
};

}  // namespace kairos
