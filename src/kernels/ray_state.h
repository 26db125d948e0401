// What one thread keeps while it traces a ray, reused from ray to ray.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <kairos/tracer.h>

#include "accel/layout.h"
#include "kernels/blended.h"
#include "kernels/moving_triangle.h"
#include "kernels/ray_frame.h"
#include "kernels/resolve.h"
#include "kernels/time_bins.h"

namespace kairos {

/// A subtree still to be visited: from which distance on, and when, in shutter time.
struct StackEntry {
  NodeRef node;
  float dist;
  float begin, end;
};

/// How far a hit's distance may leave the straight line between its ends, as a share of it, before the hit is cut in
/// two; and how often that is done. What is in front is decided on these lines, so where triangles pass through each
/// other this is what limits the accuracy of the time.
template <class Real>
inline constexpr float kLinearDistance = sizeof(Real) == 8 ? 1e-6f : 3e-4f;
template <class Real>
inline constexpr int kDeepestCut = sizeof(Real) == 8 ? 10 : 5;

/// Hits shorter than this part of the shutter are not cut: pieces around kTimeSnap would be lost one by one when what
/// is visible is resolved, and with them the whole of a hit on a triangle seen nearly edge-on.
inline constexpr float kShortestCut = 8 * kTimeSnap;

/// A key span of a block's triangles.
struct Span {
  const BlockKey &key0, &key1;
  const Row &begin, &end;  ///< shutter time

  Span(const MovingTree& tree, const MovingBlock& block, uint32_t span)
      : key0(tree.keys[block.first_key + span]),
        key1(tree.keys[block.first_key + span + 1]),
        begin(tree.times[block.first_time + span]),
        end(tree.times[block.first_time + span + 1]) {}
  Span(const BlockKey& at_begin, const BlockKey& at_end, const Row& begins, const Row& ends)
      : key0(at_begin), key1(at_end), begin(begins), end(ends) {}

  /// [key][vertex]
  std::array<std::array<Vec3f, 3>, 2> triangle(size_t lane) const {
    std::array<std::array<Vec3f, 3>, 2> position;
    for (size_t vertex = 0; vertex < 3; ++vertex)
      for (size_t axis = 0; axis < 3; ++axis) {
        position[0][vertex][static_cast<int>(axis)] = key0.position[vertex][axis][lane];
        position[1][vertex][static_cast<int>(axis)] = key1.position[vertex][axis][lane];
      }
    return position;
  }
};

/// What a ray is asked for: what hits are kept for, and what they hide.
enum class RayMode {
  visible,   ///< what is nearest: a hit hides what is behind it
  all,       ///< a hit hides nothing
  occluded,  ///< when anything is hit: a hit hides everything, as long as it lasts
};

struct RayState {
  RayMode mode = RayMode::visible;
  TraceLimits limits;
  bool limited = false;  ///< hits are not taken as they are: they are cut to the limits
  TimeBins bins;
  std::vector<Segment> hits;
  std::vector<StackEntry> stack;
  std::vector<Segment> segments;               ///< the result; of RayMode::occluded: see `covered`
  std::vector<TimeRange> covered;              ///< the result of RayMode::occluded
  std::vector<Segment> blended_hits, blended;  ///< on blended surfaces: all hits, and what can be seen of them
  ResolveScratch resolve;
  BlendedScratch clip;
  TraceCounters counters;
  const CutOuts* cut_outs = nullptr;
  const uint8_t* one_sided = nullptr;  ///< [mesh]; null: none is
  ScaledRay scaled;                    ///< what is traced, and for cut_outs; hits have its distances until end_ray
  std::vector<float> present;          ///< scratch: see CutOuts::solid_times

  /// Do hits hide anything?
  bool culls() const { return mode != RayMode::all; }
  /// Do the bins say anything?
  bool clips() const { return culls() || limited; }
  /// Do hits' distances matter, beyond their ends'?
  bool wants_distances() const { return mode == RayMode::visible || limited; }
  /// How far away does everything begin that a hit hides while it lasts? farthest: of the hit.
  float hides_from(float farthest) const { return mode == RayMode::occluded ? TimeBins::kNearest : farthest; }
  /// Is the answer complete, whatever else is met?
  bool is_complete() const { return mode == RayMode::occluded && bins.reaching(0) == 0; }

  void begin_ray(RayMode wanted, const TraceLimits& wanted_limits, uint32_t tree_depth, const ScaledRay& traced,
                 const CutOuts* missing, const uint8_t* only_fronts) {
    scaled = traced;
    cut_outs = missing;
    one_sided = only_fronts;
    mode = wanted;
    limits = wanted_limits;
    if (!scaled.is_as_given()) limits.max_dist = scaled.from_given(limits.max_dist);
    limited = !limits.is_everything();
    hits.clear();
    blended_hits.clear();
    blended.clear();
    if (limited)
      bins.clear(limits.window_begin, limits.window_end, limits.max_dist);
    else
      bins.clear();
    // Each level leaves at most all but one of its children on the stack.
    const size_t deepest = static_cast<size_t>(tree_depth) * (kWidth - 1) + kWidth;
    if (stack.size() < deepest) stack.resize(deepest);
    ++counters.rays;
  }

  void end_ray() {
    counters.hits += hits.size() + blended_hits.size();
    if (!blended_hits.empty()) clip_blended(blended_hits, hits, clip, blended);
    segments.clear();
    covered.clear();
    switch (mode) {
      case RayMode::visible:
        resolve_visible(hits, resolve, segments);
        break;
      case RayMode::all:
        order_all(hits, segments);
        break;
      case RayMode::occluded:
        unite_hits(hits, covered);
        break;
    }
    if (limited && !segments.empty()) {  // slivers at the shutter's ends may have been added to what is beside them
      segments.front().begin = std::max(segments.front().begin, limits.window_begin);
      segments.back().end = std::min(segments.back().end, limits.window_end);
      // Where a hit is cut to what is seen of it, its distance there is rounded.
      for (auto* seen : {&segments, &blended})
        for (Segment& segment : *seen) {
          segment.dist_begin = std::min(segment.dist_begin, limits.max_dist);
          segment.dist_end = std::min(segment.dist_end, limits.max_dist);
        }
    }
    counters.segments += segments.size() + blended.size() + covered.size();
    if (scaled.is_as_given()) return;
    for (auto* seen : {&segments, &blended})
      for (Segment& segment : *seen) {
        segment.dist_begin = scaled.to_given(segment.dist_begin);
        segment.dist_end = scaled.to_given(segment.dist_end);
      }
  }

  /// False where the side that is met is not there. A hit ends where the triangle turns its other side: its three edge
  /// functions have one sign while it lasts, and front or back is that sign.
  bool shows(const Segment& hit) const { return hit.front || one_sided == nullptr || one_sided[hit.mesh] == 0; }
  /// True when nothing of the mesh is missing and it is not blended.
  bool is_whole(uint32_t mesh) const { return cut_outs == nullptr || !cut_outs->has(mesh); }
  /// True when hits on the mesh are taken as they are.
  bool takes_whole(uint32_t mesh) const { return !limited && is_whole(mesh); }

  /// Accepts what is known to be there for the whole shutter, if it has any duration.
  void add_occluder_hint(Segment hit) {
    if (!(hit.begin < hit.end)) return;
    if (!scaled.is_as_given()) {
      hit.dist_begin = scaled.from_given(hit.dist_begin);
      hit.dist_end = scaled.from_given(hit.dist_end);
    }
    if (cut_to_limits(hit)) accept(hit);
  }

  /// Accepts what is there of a hit in shutter time, unless something is known to hide it.
  void add(Segment hit) {
    if (!(hit.begin < hit.end) || !shows(hit) || is_hidden(hit) || !cut_to_limits(hit)) return;
    if (is_whole(hit.mesh)) return accept(hit);
    if (cut_outs->is_blended(hit.mesh)) return accept_blended(hit);
    cut_outs->solid_times(scaled.ray, hit, present);
    const float slope = (hit.dist_end - hit.dist_begin) / hit.duration();
    for (size_t i = 0; i + 1 < present.size(); i += 2) {
      Segment part = hit;
      part.begin = present[i];
      part.end = present[i + 1];
      if (part.begin > hit.begin) part.dist_begin = hit.dist_begin + slope * (part.begin - hit.begin);
      if (part.end < hit.end) part.dist_end = hit.dist_begin + slope * (part.end - hit.begin);
      if (part.begin < part.end) accept(part);
    }
  }

  /// Whether a hit that lasts for the whole shutter, on what stands still, is there to hide what is behind it. What is
  /// met of a blended mesh is accepted here.
  bool is_there(Segment hit) {
    if (!shows(hit)) return false;
    if (is_whole(hit.mesh)) return true;
    if (!cut_outs->is_blended(hit.mesh)) return cut_outs->solid(scaled.ray, hit.mesh, hit.triangle, hit.begin);
    if (mode == RayMode::all) return true;
    if (cut_to_limits(hit)) accept_blended(hit);
    return false;
  }

 private:
  bool is_hidden(const Segment& hit) const {
    return clips() &&
           (bins.reaching(std::min(hit.dist_begin, hit.dist_end)) & TimeBins::touched(hit.begin, hit.end)) == 0;
  }
  /// Leaves of a hit what is within the limits; false when nothing is.
  bool cut_to_limits(Segment& hit) const {
    if (!limited) return true;
    float begin = std::max(hit.begin, limits.window_begin), end = std::min(hit.end, limits.window_end);
    const float slope = (hit.dist_end - hit.dist_begin) / hit.duration();
    const bool far_at_begin = hit.dist_begin > limits.max_dist, far_at_end = hit.dist_end > limits.max_dist;
    if (far_at_begin && far_at_end) return false;
    if (far_at_begin || far_at_end) {
      const float reached = hit.begin + (limits.max_dist - hit.dist_begin) / slope;
      if (far_at_begin)
        begin = std::max(begin, reached);
      else
        end = std::min(end, reached);
    }
    if (!(begin < end)) return false;
    const auto distance = [&](float time) { return hit.dist_begin + slope * (time - hit.begin); };
    const float dist_begin = begin > hit.begin ? distance(begin) : hit.dist_begin;
    if (end < hit.end) hit.dist_end = distance(end);
    // Both ends, also one that was not moved: `reached` may round to it.
    hit.dist_end = std::min(hit.dist_end, limits.max_dist);
    hit.dist_begin = std::min(dist_begin, limits.max_dist);
    hit.begin = begin;
    hit.end = end;
    return true;
  }
  void accept(const Segment& hit) {
    if (culls()) bins.cover(hit.begin, hit.end, hides_from(std::max(hit.dist_begin, hit.dist_end)));
    hits.push_back(hit);
  }
  void accept_blended(const Segment& hit) {
    if (mode == RayMode::visible) blended_hits.push_back(hit);
    if (mode == RayMode::all) accept(hit);
  }
};

/// Maps the time of a key span to shutter time; its end to its end, exactly.
inline float to_shutter_time(float time, float span_begin, float span_end) {
  return time >= 1 ? span_end : span_begin + time * (span_end - span_begin);
}

template <class Real>
Segment to_segment(const HitInterval<Real>& hit, uint32_t mesh, uint32_t triangle, float span_begin, float span_end) {
  return {to_shutter_time(static_cast<float>(hit.begin), span_begin, span_end),
          to_shutter_time(static_cast<float>(hit.end), span_begin, span_end),
          static_cast<float>(hit.dist_begin),
          static_cast<float>(hit.dist_end),
          mesh,
          triangle,
          hit.front};
}

/// Hands on a hit to `add`, in shutter time; where distances matter and this one does not run straight between the
/// hit's ends, in pieces in which it does.
template <class Real, class Add>
void add_in_pieces(const RayState& state, const FramedTriangle<Real>& f, const std::array<Quadratic<Real>, 3>& e,
                   const HitInterval<Real>& hit, uint32_t mesh, uint32_t triangle, float span_begin, float span_end,
                   const Add& add, int cuts = 0) {
  const Real duration = (hit.end - hit.begin) * Real(span_end - span_begin);
  if (state.wants_distances() && cuts < kDeepestCut<Real> && duration > Real(kShortestCut)) {
    const Real middle = Real(0.5) * (hit.begin + hit.end);
    const Real dist = distance_at(f, e, middle);
    const Real straight = Real(0.5) * (hit.dist_begin + hit.dist_end);
    if (std::abs(dist - straight) > Real(kLinearDistance<Real>) * dist) {
      add_in_pieces<Real>(state, f, e, {hit.begin, middle, hit.dist_begin, dist, hit.front}, mesh, triangle, span_begin,
                          span_end, add, cuts + 1);
      add_in_pieces<Real>(state, f, e, {middle, hit.end, dist, hit.dist_end, hit.front}, mesh, triangle, span_begin,
                          span_end, add, cuts + 1);
      return;
    }
  }
  add(to_segment(hit, mesh, triangle, span_begin, span_end));
}

}  // namespace kairos
