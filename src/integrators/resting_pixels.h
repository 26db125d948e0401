// Pixels in which nothing moves but shadows and what mirrors show.
#pragma once

#include <algorithm>

#include "integrators/still_layer.h"
#include "pixel/record_builder.h"
#include "policy/shadow_prices.h"
#include "shading/exact_mirrors.h"
#include "shading/exact_shadows.h"

namespace kairos {

/// What stands still is sampled by many discrete rays as if nothing passed before its resting lights, nor in mirrors at
/// rest. What those that move take away, and change in mirrors, is found exactly in time, along the first few of the
/// same rays. With E their mean so, S' their mean as if nothing passed, and S that of all, the pixel is E + (S - S'):
/// the still term of its record, with a share of
/// 1. docs/method.md, "Shadows exact in time". One thread's scratch memory.
class RestingPixels {
 public:
  /// mirrors: null where they are sampled. sample_time: of a shading sample, in nanoseconds.
  RestingPixels(const ExactShadows& shadows, const ExactMirrors* mirrors, double sample_time)
      : shadows_(shadows), mirrors_(mirrors), sample_time_(sample_time) {}

  /// As which the still rays are to be shaded.
  const ExactShadows* shadows() const { return &shadows_; }
  const ExactMirrors* mirrors() const { return mirrors_; }

  /// Makes rays of `out` over all of the window of the first `count` still rays that are in it, which were shaded with
  /// the same shadows. look_ups: by which they were; null: at once.
  void add_exact(const StillLayer& still, uint32_t count, const TimeRange& window, RecordBuilder& out,
                 LookUps* look_ups = nullptr) {
    changes_ = false;
    look_ups_ = look_ups;
    for (uint32_t i = 0; i < count; ++i) {
      const PixelRay sampled = out.still_rays()[i];
      const uint32_t first = out.part_count();
      if (sampled.parts > 0) add_parts(still.ray(i), still.key(i), out.parts()[sampled.first_part], window, out);
      out.add_ray({sampled.film, 1, PixelRay::kAll, first, out.part_count() - first, sampled.parts});
    }
    out.set_still(count, 1);
  }

  /// Does anything that moves pass in the mirror that the ray meets, if it meets one? Of a ray that none of the pixel's
  /// depends on, so that who takes more of them for it stays right in the mean.
  bool passes_in_mirror(const Ray& ray, const DiscreteHit& still, const TimeRange& window) {
    if (mirrors_ == nullptr || !mirrors_->on(still.mesh)) return false;
    sum_.clear();
    passing_.look(*mirrors_, ray, still.mesh, still.triangle, still.dist, {}, window, sum_);
    return passing_.changes();
  }

  /// Did anything pass before a light of those rays, or in a mirror?
  bool changes() const { return changes_; }
  TraceCounters counters() const {
    TraceCounters sum = steps_.counters();
    sum += passing_.counters();
    return sum;
  }
  /// Nanoseconds that all of this has taken so far, as those of shadow_prices.h.
  double time() const {
    const TraceCounters seen = passing_.counters();
    const double in_mirrors = tracing_time(static_cast<double>(seen.nodes), static_cast<double>(seen.triangles),
                                           static_cast<double>(seen.hits));
    return exact_look_time(static_cast<double>(looks_), steps_.counters()) + in_mirrors +
           sample_time_ * static_cast<double>(passing_.evaluations());
  }

 private:
  void add_parts(const Ray& ray, SampleKey key, SeenPart seen, const TimeRange& window, RecordBuilder& out) {
    Segment& where = seen.where;
    const Vec3f colour = out.knots()[seen.first_knot].colour;
    const KnotSurface surface = out.surface(seen.first_knot);
    const auto awaited = look_ups_ != nullptr ? look_ups_->awaited_by(seen.first_knot) : std::nullopt;
    const auto add = [&](float begin, float end, Vec3f shown) {
      where.begin = begin;
      where.end = end;
      if (awaited) look_ups_->link(out.knot_count(), *awaited);
      out.add_part({where, out.add_knot(begin + (end - begin) * 0.5f, shown, surface.normal, surface.albedo)});
    };
    if (where.mesh != kNoMesh && mirrors_ != nullptr && mirrors_->on(where.mesh)) {
      sum_.clear();
      ++looks_;
      passing_.look(*mirrors_, ray, where.mesh, where.triangle, where.dist_begin, key, window, sum_);
      changes_ = changes_ || passing_.changes();
      sum_.visit(window.begin, window.end,
                 [&](float begin, float end, Vec3f change) { add(begin, end, colour + change); });
      return;
    }
    if (where.mesh == kNoMesh || !shadows_.on(where.mesh)) return add(window.begin, window.end, colour);
    ++looks_;
    const Vec3f unhidden = steps_.look_at_still(shadows_, ray, where.mesh, where.triangle);
    steps_.look_at_motion(shadows_, window);
    changes_ = changes_ || steps_.changes();
    float begin = window.begin;
    for (const auto& step : steps_.steps()) {
      Vec3f left = colour - (unhidden - step.light);
      // Where a light only just peeps past an edge, packets of rays and single ones may disagree whether it does.
      if (!awaited) left = {std::max(left.x, 0.0f), std::max(left.y, 0.0f), std::max(left.z, 0.0f)};
      add(begin, step.end, left);
      begin = step.end;
    }
  }

  const ExactShadows& shadows_;
  const ExactMirrors* const mirrors_;
  const double sample_time_;
  LookUps* look_ups_ = nullptr;
  RestingLightSteps steps_;
  PassingInMirrors passing_;
  StepSum sum_;
  uint64_t looks_ = 0;
  bool changes_ = false;
};

}  // namespace kairos
