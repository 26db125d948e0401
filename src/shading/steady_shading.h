// Colours of a ray over time that change by what changes in the scene alone, to a bound: for who looks at differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/exact_shadows.h"
#include "shading/layers.h"
#include "shading/roulette.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// One thread's scratch memory. See RecordNeeds::contrast.
class SteadyShading {
 public:
  SteadyShading(const Shader& shader, const ShadingOptions& options)
      : shader_(shader),
        options_(options),
        half_cell_(0.5f * (options.grid.time_at(1) - options.grid.time_at(0))),
        jump_(kJump * 2 * half_cell_) {}

  /// Appends the parts of ray `index` of a pixel to `out`: one for each segment, or for each layer of what is seen
  /// through blended surfaces. Returns the number of evaluations.
  uint64_t shade(const Ray& ray, std::span<const Segment> segments, std::span<const Segment> blended,
                 const TimeRange& window, uint64_t pixel_seed, uint32_t index, RecordBuilder& out) {
    key_ = {hash(pixel_seed, kSteadyDimension), index};
    evaluations_ = 0;
    window_ = window;
    steady_.clear();
    if (blended.empty() && !shader_.has_sky()) {
      for (const Segment& seen : segments) add(ray, seen, seen.begin, seen.end, 0, 1, out);
      return evaluations_;
    }
    opacities_.clear();
    for (const Segment& hit : blended)
      opacities_.push_back(shader_.opacity(ray, hit.mesh, hit.triangle, 0.5f * (hit.begin + hit.end)));
    layers_.build(segments, blended, shader_.has_sky(), opacities_, window);
    for (size_t i = 0; i < layers_.stretches().size(); ++i) {
      const Segment& seen = layers_.stretches()[i];
      if (layers_.before(i).empty() && !layers_.is_cut(i))
        add(ray, seen, seen.begin, seen.end, 0, 1, out);
      else
        add_stretch(ray, i, blended, out);
    }
    return evaluations_;
  }

  TraceCounters shadow_counters() const { return steps_.counters(); }  ///< of exact shadows

 private:
  static constexpr uint64_t kSteadyDimension = 7;  // beside those of other samples
  /// A change by so many times what straight lines may be off by, within so short a part of a cell, is a jump. Smaller
  /// ones may take as much longer: what lies between the jump and the line in its place stays the same.
  static constexpr float kThreshold = 50, kJump = 0x1p-11f;
  static constexpr float kShortest = 0x1p-19f;  // of the shutter: no jump is known better
  /// Of a segment: more are spent on noise, which no number of them would follow.
  static constexpr uint32_t kMostRefined = 4096;

  /// The opacity of a layer holds for a cell of the grid: as it is halfway through.
  void add_stretch(const Ray& ray, size_t index, std::span<const Segment> blended, RecordBuilder& out) {
    const Segment& back = layers_.stretches()[index];
    const std::span<const uint32_t> before = layers_.before(index);
    float begin = back.begin;
    for (double cell = std::floor(options_.grid.place(begin)) + 1; begin < back.end; ++cell) {
      const float end = std::clamp(options_.grid.time_at(cell), begin, back.end);
      if (!(begin < end)) continue;
      uint32_t layer = 0;
      float open = 1;
      const float middle = 0.5f * (begin + end);
      const auto add_blended = [&](const Segment& hit) {
        if (open < kLeastOpen) return;
        const float opacity = shader_.opacity(ray, hit.mesh, hit.triangle, middle);
        if (!(opacity > 0)) return;
        add(ray, hit, begin, end, layer++, opacity, out);
        open *= 1 - opacity;
      };
      for (const uint32_t hit : before) add_blended(blended[hit]);
      if (layers_.is_cut(index)) {
        layers_.find_farther(index, middle, blended, farther_);
        for (const uint32_t hit : farther_) add_blended(blended[hit]);
      }
      if (open >= kLeastOpen && (back.mesh != kNoMesh || shader_.has_sky() || layer == 0))
        add(ray, back, begin, end, layer, 1, out);
      begin = end;
    }
  }

  /// What is seen of a surface or of the sky from `begin` to `end`. Each segment by itself, even where colours go on
  /// from one to the next: looks at their ends find shadows that pass.
  void add(const Ray& ray, const Segment& seen, float begin, float end, uint32_t layer, float opacity,
           RecordBuilder& out) {
    const bool sky = seen.mesh == kNoMesh;
    const auto look = [&](float time) {
      ++evaluations_;
      if (sky) return Instant{time, {shader_.sky(ray, time), {}, {}}};
      return Instant{time, shader_.shade(ray, seen.mesh, seen.triangle, time, key_)};
    };
    instants_.clear();
    // Half-open: at its very end something else is seen.
    const float latest = std::max(begin, std::nextafter(end, 0.0f));
    if (const Steady* known = sky ? nullptr : find_steady(ray, seen)) {
      add_steps(*known, begin, latest);
    } else if (!(sky ? shader_.sky_varies() : shader_.varies(seen.mesh)) || !(begin < latest)) {
      instants_.push_back(look(begin));
    } else {
      refined_ = 0;
      Instant before = look(begin);
      instants_.push_back(before);
      while (before.time < latest) {
        const bool early = before.time < options_.looks_begin, late = before.time >= options_.looks_end;
        const float next = early ? options_.looks_begin : late ? latest : next_cell(before.time);
        const Instant after = look(std::min(next, latest));
        if (!early && !late) refine(before, after, true, look);
        instants_.push_back(after);
        before = after;
      }
    }
    const auto add_knot = [&](float time, const Shade& shade) {
      return out.add_knot(time, shade.colour, shade.normal, shade.albedo);
    };
    const uint32_t knot = add_knot(instants_[0].time, instants_[0].shade);
    for (const Instant& instant : std::span(instants_).subspan(1)) add_knot(instant.time, instant.shade);
    out.add_part({{begin, end, distance_at(seen, begin), distance_at(seen, end), seen.mesh, seen.triangle, seen.front},
                  knot,
                  static_cast<uint32_t>(instants_.size()),
                  layer,
                  opacity});
  }

  /// A triangle that a ray sees and whose light changes in steps alone, or not.
  struct Steady {
    uint32_t mesh, triangle;
    bool in_steps;
    Shade base;
    std::vector<RestingLightSteps::Step> steps;
  };

  /// Null where light changes otherwise, too.
  const Steady* find_steady(const Ray& ray, const Segment& seen) {
    if (options_.shadows == nullptr || !options_.shadows->on(seen.mesh)) return nullptr;
    auto known = std::find_if(steady_.begin(), steady_.end(), [&](const Steady& one) {
      return one.mesh == seen.mesh && one.triangle == seen.triangle;
    });
    if (known == steady_.end()) {
      ++evaluations_;
      const ShadingQuery query{ray, seen.mesh, seen.triangle, window_.begin, 0, key_};
      Steady found{seen.mesh, seen.triangle, false, {}, {}};
      steps_.clear();
      found.in_steps = steps_.add_with_all(*options_.shadows, query, found.base);
      steps_.look(*options_.shadows, window_);
      if (found.in_steps) found.steps.assign(steps_.steps().begin(), steps_.steps().end());
      steady_.push_back(std::move(found));
      known = steady_.end() - 1;
    }
    return known->in_steps ? &*known : nullptr;
  }

  /// Instants at which the colour is constant in between, but for the shortest moments.
  void add_steps(const Steady& seen, float begin, float latest) {
    const auto add_instant = [&](float time, const RestingLightSteps::Step& step) {
      Instant instant{time, seen.base};
      instant.shade.colour = shader_.limited(step.light);
      instants_.push_back(instant);
    };
    auto step = seen.steps.begin();
    while (step + 1 != seen.steps.end() && step->end <= begin) ++step;
    add_instant(begin, *step);
    for (; step + 1 != seen.steps.end() && step->end < latest; ++step) {
      add_instant(step->end, *step);
      add_instant(std::nextafter(step->end, 2.0f), *(step + 1));
    }
    add_instant(latest, *step);
  }

  /// When the next cell of the grid begins.
  float next_cell(float time) const {
    for (double cell = std::floor(options_.grid.place(time)) + 1;; ++cell)
      if (const float next = options_.grid.time_at(cell); time < next) return next;
  }

  struct Instant {
    float time;
    Shade shade;
  };

  /// Looks at the middle until the straight line is near enough there, or what is left is a jump.
  /// first: nothing is known of what happens between the two; later, what is the same on both sides has been there.
  template <class Look>
  void refine(const Instant& before, const Instant& after, bool first, const Look& look) {
    const float length = after.time - before.time;
    if (length < kShortest || refined_ >= kMostRefined) return;
    const float off = times_off(after.shade.colour - before.shade.colour, before.shade.colour);
    // What comes and goes within half a cell may be missed.
    const bool known = !first || length <= half_cell_;
    if (known && (off <= 1 || off * length < kThreshold * jump_)) return;
    const float time = before.time + 0.5f * (after.time - before.time);
    if (!(before.time < time && time < after.time)) return;
    ++refined_;
    const Instant middle = look(time);
    const bool straight = times_off_straight(before.shade.colour, middle.shade.colour, after.shade.colour) <= 1;
    if (!straight) refine(before, middle, false, look);
    instants_.push_back(middle);
    if (!straight) refine(middle, after, false, look);
  }

  float times_off_straight(Vec3f before, Vec3f middle, Vec3f after) const {
    return times_off(middle - (before + after) * 0.5f, middle);
  }
  /// In units of what straight lines may be off by.
  float times_off(Vec3f off, Vec3f colour) const {
    const float bright = 0.2126f * colour.x + 0.7152f * colour.y + 0.0722f * colour.z;  // Rec. 709
    return std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) /
           (options_.contrast * (std::max(bright, 0.0f) + options_.dark));
  }

  const Shader& shader_;
  ShadingOptions options_;
  float half_cell_, jump_;  // shutter time
  SampleKey key_{};
  Layers layers_;
  std::vector<float> opacities_;  // [blended hit], halfway through
  std::vector<uint32_t> farther_;
  std::vector<Instant> instants_;
  uint32_t refined_ = 0;
  uint64_t evaluations_ = 0;
  TimeRange window_{};
  RestingLightSteps steps_;
  std::vector<Steady> steady_;  // of the ray
};

}  // namespace kairos
