// Pixels in which nothing moves but shadows and what mirrors show.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

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

  // Exact looks of pixels beside each other may be made together, before any of them is shaded.
  void begin_strip() {
    strip_steps_.clear();
    strip_points_.clear();
    strip_pixels_.clear();
  }
  /// Along the first `count` still rays of a pixel.
  void add_to_strip(int x, StillLayer& still, uint32_t count, Monitor& monitor) {
    const auto hits = still.hits(count, monitor);
    strip_pixels_.push_back({x, strip_points_.size(), count});
    for (uint32_t i = 0; i < count; ++i) {
      strip_points_.push_back(strip_steps_.points());
      if (hits[i] && has_shadows(hits[i]->mesh))
        strip_steps_.add(shadows_, still.ray(i), hits[i]->mesh, hits[i]->triangle);
    }
  }
  void look_at_strip(const TimeRange& window) { strip_steps_.look(shadows_, window); }

  /// Makes rays of `out` over all of the window of the first `count` still rays that are in it, which were shaded with
  /// the same shadows; those that are in the strip as pixel x's were looked at with it. look_ups: by which the rays
  /// were shaded; null: at once.
  void add_exact(int x, const StillLayer& still, uint32_t count, const TimeRange& window, RecordBuilder& out,
                 LookUps* look_ups = nullptr) {
    const auto in_strip = points_in_strip(x);
    changes_ = false;
    look_ups_ = look_ups;
    steps_.clear();
    for (uint32_t i = static_cast<uint32_t>(in_strip.size()); i < count; ++i)
      if (const PixelRay ray = out.still_rays()[i]; ray.parts > 0)
        if (const Segment& where = out.parts()[ray.first_part].where; has_shadows(where.mesh))
          steps_.add(shadows_, still.ray(i), where.mesh, where.triangle);
    steps_.look(shadows_, window);
    looks_ += steps_.points();
    changes_ = steps_.changes();
    Looked looked{&strip_steps_, 0};
    for (uint32_t i = 0; i < count; ++i) {
      if (i < in_strip.size())
        looked.point = in_strip[i];
      else if (i == in_strip.size())
        looked = {&steps_, 0};
      const PixelRay sampled = out.still_rays()[i];
      const uint32_t first = out.part_count();
      if (sampled.parts > 0)
        add_parts(still.ray(i), still.key(i), out.parts()[sampled.first_part], looked, window, out);
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

  /// Did anything pass before a light of those rays that were in no strip, or in a mirror?
  bool changes() const { return changes_; }
  TraceCounters counters() const {
    TraceCounters sum = steps_.counters();
    sum += strip_steps_.counters();
    sum += passing_.counters();
    return sum;
  }
  /// Nanoseconds that all of this but strips has taken so far, as those of shadow_prices.h.
  double time() const {
    const TraceCounters seen = passing_.counters();
    const double in_mirrors = tracing_time(static_cast<double>(seen.nodes), static_cast<double>(seen.triangles),
                                           static_cast<double>(seen.hits));
    return exact_look_time(static_cast<double>(looks_), steps_.counters()) + in_mirrors +
           sample_time_ * static_cast<double>(passing_.evaluations());
  }

 private:
  struct StripPixel {
    int x;
    size_t first;  // of strip_points_
    uint32_t count;
  };
  std::span<const size_t> points_in_strip(int x) const {
    for (const StripPixel& pixel : strip_pixels_)
      if (pixel.x == x) return std::span(strip_points_).subspan(pixel.first, pixel.count);
    return {};
  }

  bool is_exact_mirror(uint32_t mesh) const { return mesh != kNoMesh && mirrors_ != nullptr && mirrors_->on(mesh); }
  bool has_shadows(uint32_t mesh) const { return mesh != kNoMesh && !is_exact_mirror(mesh) && shadows_.on(mesh); }

  /// The next point with shadows.
  struct Looked {
    const RestingLightSteps* steps;
    size_t point;
  };

  void add_parts(const Ray& ray, SampleKey key, SeenPart seen, Looked& looked, const TimeRange& window,
                 RecordBuilder& out) {
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
    if (is_exact_mirror(where.mesh)) {
      sum_.clear();
      ++looks_;
      passing_.look(*mirrors_, ray, where.mesh, where.triangle, where.dist_begin, key, window, sum_);
      changes_ = changes_ || passing_.changes();
      sum_.visit(window.begin, window.end,
                 [&](float begin, float end, Vec3f change) { add(begin, end, colour + change); });
      return;
    }
    if (!has_shadows(where.mesh)) return add(window.begin, window.end, colour);
    float begin = window.begin;
    for (const auto& step : looked.steps->steps(looked.point)) {
      Vec3f left = colour - (looked.steps->unhidden(looked.point) - step.light);
      // Where a light only just peeps past an edge, packets of rays and single ones may disagree whether it does.
      if (!awaited) left = {std::max(left.x, 0.0f), std::max(left.y, 0.0f), std::max(left.z, 0.0f)};
      add(begin, step.end, left);
      begin = step.end;
    }
    ++looked.point;
  }

  const ExactShadows& shadows_;
  const ExactMirrors* const mirrors_;
  const double sample_time_;
  LookUps* look_ups_ = nullptr;
  RestingLightSteps steps_, strip_steps_;
  std::vector<StripPixel> strip_pixels_;
  std::vector<size_t> strip_points_;  // of strip_steps_, by rays; of those with shadows
  PassingInMirrors passing_;
  StepSum sum_;
  uint64_t looks_ = 0;
  bool changes_ = false;
};

}  // namespace kairos
