// Pixels in which nothing moves but shadows.
#pragma once

#include <algorithm>

#include "integrators/still_layer.h"
#include "pixel/record_builder.h"
#include "policy/shadow_prices.h"
#include "shading/exact_shadows.h"

namespace kairos {

/// What stands still is sampled by many discrete rays as if nothing passed before its resting lights. What those that
/// move take away is found exactly in time, along the first few of the same rays. With E their mean so, S' their mean
/// as if nothing passed, and S that of all, the pixel is E + (S - S'): the still term of its record, with a share of
/// 1. docs/method.md, "Shadows exact in time". One thread's scratch memory.
class RestingPixels {
 public:
  explicit RestingPixels(const ExactShadows& shadows) : shadows_(shadows) {}

  /// Makes rays of `out` over all of the window of the first `count` still rays that are in it, which were shaded with
  /// the same shadows.
  void add_exact(const StillLayer& still, uint32_t count, const TimeRange& window, RecordBuilder& out) {
    changes_ = false;
    for (uint32_t i = 0; i < count; ++i) {
      const PixelRay sampled = out.still_rays()[i];
      const uint32_t first = out.part_count();
      if (sampled.parts > 0) add_parts(still.ray(i), out.parts()[sampled.first_part], window, out);
      out.add_ray({sampled.film, 1, PixelRay::kAll, first, out.part_count() - first, sampled.parts});
    }
    out.set_still(count, 1);
  }

  /// Did anything pass before a light of those rays?
  bool changes() const { return changes_; }
  TraceCounters counters() const { return steps_.counters(); }
  /// Nanoseconds that all of this has taken so far, as those of shadow_prices.h.
  double time() const { return exact_look_time(static_cast<double>(looks_), steps_.counters()); }

 private:
  void add_parts(const Ray& ray, SeenPart seen, const TimeRange& window, RecordBuilder& out) {
    Segment& where = seen.where;
    const Vec3f colour = out.knots()[seen.first_knot].colour;
    const KnotSurface surface = out.surface(seen.first_knot);
    const auto add = [&](float begin, float end, Vec3f shown) {
      where.begin = begin;
      where.end = end;
      out.add_part({where, out.add_knot(begin + (end - begin) * 0.5f, shown, surface.normal, surface.albedo)});
    };
    if (where.mesh == kNoMesh || !shadows_.on(where.mesh)) return add(window.begin, window.end, colour);
    ++looks_;
    const Vec3f unhidden = steps_.look_at_still(shadows_, ray, where.mesh, where.triangle);
    steps_.look_at_motion(shadows_, window);
    changes_ = changes_ || steps_.changes();
    float begin = window.begin;
    for (const auto& step : steps_.steps()) {
      // Where a light only just peeps past an edge, packets of rays and single ones may disagree whether it does.
      const Vec3f left = colour - (unhidden - step.light);
      add(begin, step.end, {std::max(left.x, 0.0f), std::max(left.y, 0.0f), std::max(left.z, 0.0f)});
      begin = step.end;
    }
  }

  const ExactShadows& shadows_;
  RestingLightSteps steps_;
  uint64_t looks_ = 0;
  bool changes_ = false;
};

}  // namespace kairos
