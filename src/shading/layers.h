// What a time-continuous ray sees through: the shutter cut into stretches in which the same surfaces lie behind each
// other in the same order.
#pragma once

#include <span>
#include <vector>

#include <kairos/tracer.h>

namespace kairos {

/// One ray's; reused from ray to ray.
class Layers {
 public:
  /// segments and blended: as the tracer hands them over. fill_gaps: make stretches of those in which nothing is seen,
  /// too. opacities: of each blended hit, about; empty: unknown. What lies behind so many that less than kLeastOpen of
  /// the light from there comes through cuts no stretches, so that there are about as many as changes that can be seen.
  /// window: that of the rays, which gaps are filled in.
  void build(std::span<const Segment> segments, std::span<const Segment> blended, bool fill_gaps,
             std::span<const float> opacities = {}, const TimeRange& window = {});

  /// Disjoint, in time order. Of each: the part of a segment that lies behind all of its blended surfaces, or one with
  /// the mesh kNoMesh and at infinity, where nothing does.
  std::span<const Segment> stretches() const { return stretches_; }
  /// Indices of the blended hits before stretch `index`, front to back; if it is_cut, only the nearest.
  std::span<const uint32_t> before(size_t index) const {
    return {order_.data() + (index == 0 ? 0 : ends_[index - 1]), order_.data() + ends_[index]};
  }
  bool is_cut(size_t index) const { return is_cut_[index]; }
  /// Replaces `farther` by the blended hits that are there at `time`, in stretch `index`, and not in before(index),
  /// front to back.
  void find_farther(size_t index, float time, std::span<const Segment> blended, std::vector<uint32_t>& farther);

 private:
  /// A blended hit at an instant.
  struct Candidate {
    float dist;
    uint32_t hit;
  };

  void find_cuts(std::span<const Segment> segments, std::span<const Segment> blended, const TimeRange& window);
  void take_nearest(std::span<const Segment> blended, float time, std::span<const float> opacities);
  void add(const Segment& back, std::span<const Segment> blended);

  std::vector<float> cuts_;
  std::vector<uint32_t> active_;  // blended hits of the piece between two cuts that is being looked at
  std::vector<Candidate> heap_;
  std::vector<uint32_t> nearest_;  // of active_, front to back
  bool has_farther_ = false;       // of active_
  std::vector<Segment> stretches_;
  std::vector<size_t> ends_;  // [stretch]: end of its part of order_
  std::vector<bool> is_cut_;  // [stretch]
  std::vector<uint32_t> order_;
};

/// The distance along a straight line between a segment's ends; not beyond them.
inline float distance_at(const Segment& s, float time) {
  if (time <= s.begin) return s.dist_begin;
  if (time >= s.end) return s.dist_end;
  return s.dist_begin + (s.dist_end - s.dist_begin) * ((time - s.begin) / s.duration());
}

}  // namespace kairos
