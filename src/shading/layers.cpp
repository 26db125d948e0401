#include "shading/layers.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include <kairos/record.h>

#include "shading/roulette.h"

namespace kairos {

namespace {

// Cuts closer than this, in parts of the window, are one: what rounding leaves between a segment's end and the next
// begin.
constexpr float kSliver = 1e-6f;

bool same_surface(const Segment& a, const Segment& b) {
  return a.mesh == b.mesh && a.triangle == b.triangle && a.front == b.front;
}

}  // namespace

void Layers::find_cuts(std::span<const Segment> segments, std::span<const Segment> blended, const TimeRange& window) {
  cuts_.assign({window.begin, window.end});
  const auto add_ends = [&](std::span<const Segment> list) {
    for (const Segment& s : list) cuts_.insert(cuts_.end(), {s.begin, s.end});
  };
  add_ends(segments);
  add_ends(blended);
  for (size_t i = 0; i < blended.size(); ++i)
    for (size_t j = i + 1; j < blended.size() && blended[j].begin < blended[i].end; ++j) {
      const float begin = blended[j].begin, end = std::min(blended[i].end, blended[j].end);
      const float first = distance_at(blended[i], begin) - distance_at(blended[j], begin);
      const float last = distance_at(blended[i], end) - distance_at(blended[j], end);
      if ((first < 0 && last > 0) || (first > 0 && last < 0))
        cuts_.push_back(std::clamp(begin + (end - begin) * (first / (first - last)), begin, end));
    }
  std::sort(cuts_.begin(), cuts_.end());
  size_t kept = 1;
  for (const float cut : cuts_)
    if (cut - cuts_[kept - 1] >= kSliver * (window.end - window.begin)) cuts_[kept++] = cut;
  cuts_.resize(kept);
  cuts_.back() = window.end;
}

/// Fills nearest_ from active_.
void Layers::take_nearest(std::span<const Segment> blended, float time, std::span<const float> opacities) {
  const auto farther = [&](const Candidate& a, const Candidate& b) {
    const Segment &one = blended[a.hit], &other = blended[b.hit];
    return std::tie(a.dist, one.mesh, one.triangle, a.hit) > std::tie(b.dist, other.mesh, other.triangle, b.hit);
  };
  heap_.clear();
  for (const uint32_t hit : active_) heap_.push_back({distance_at(blended[hit], time), hit});
  std::make_heap(heap_.begin(), heap_.end(), farther);
  nearest_.clear();
  float open = 1;
  while (!heap_.empty() && open >= kLeastOpen) {
    std::pop_heap(heap_.begin(), heap_.end(), farther);
    nearest_.push_back(heap_.back().hit);
    heap_.pop_back();
    if (!opacities.empty()) open *= 1 - opacities[nearest_.back()];
  }
  has_farther_ = !heap_.empty();
}

void Layers::find_farther(size_t index, float time, std::span<const Segment> blended, std::vector<uint32_t>& farther) {
  const std::span<const uint32_t> nearest = before(index);
  // By surface: of one of them there may be two hits one after the other, of which `nearest` names the first.
  const auto is_near = [&](const Segment& hit) {
    return std::any_of(nearest.begin(), nearest.end(), [&](uint32_t n) { return same_surface(blended[n], hit); });
  };
  active_.clear();
  for (uint32_t hit = 0; hit < blended.size() && blended[hit].begin <= time; ++hit)
    if (time < blended[hit].end && !is_near(blended[hit])) active_.push_back(hit);
  take_nearest(blended, time, {});
  farther = nearest_;
}

void Layers::build(std::span<const Segment> segments, std::span<const Segment> blended, bool fill_gaps,
                   std::span<const float> opacities, const TimeRange& window) {
  stretches_.clear();
  ends_.clear();
  is_cut_.clear();
  order_.clear();
  active_.clear();
  find_cuts(segments, blended, window);
  size_t seen = 0;
  uint32_t next = 0;  // of the blended hits
  for (size_t i = 0; i + 1 < cuts_.size(); ++i) {
    const float begin = cuts_[i], end = cuts_[i + 1], middle = 0.5f * (begin + end);
    while (seen < segments.size() && segments[seen].end <= middle) ++seen;
    while (next < blended.size() && blended[next].begin <= middle) active_.push_back(next++);
    active_.erase(
        std::remove_if(active_.begin(), active_.end(), [&](uint32_t hit) { return blended[hit].end <= middle; }),
        active_.end());
    const bool is_gap = seen == segments.size() || segments[seen].begin > middle;
    if (is_gap && active_.empty() && !fill_gaps) continue;
    take_nearest(blended, middle, opacities);
    constexpr float kFar = std::numeric_limits<float>::infinity();
    Segment back{begin, end, kFar, kFar, kNoMesh, 0, false};
    if (!is_gap) {
      back = segments[seen];
      back.dist_begin = distance_at(segments[seen], begin);
      back.dist_end = distance_at(segments[seen], end);
      back.begin = begin;
      back.end = end;
    }
    add(back, blended);
  }
}

/// Lengthens the last stretch, where nothing but the hit intervals' ends lies in between.
void Layers::add(const Segment& back, std::span<const Segment> blended) {
  if (!stretches_.empty() && stretches_.back().end == back.begin && same_surface(stretches_.back(), back)) {
    const std::span<const uint32_t> last = before(stretches_.size() - 1);
    if (std::equal(last.begin(), last.end(), nearest_.begin(), nearest_.end(),
                   [&](uint32_t a, uint32_t b) { return same_surface(blended[a], blended[b]); })) {
      if (has_farther_) is_cut_.back() = true;
      stretches_.back().end = back.end;
      stretches_.back().dist_end = back.dist_end;
      return;
    }
  }
  stretches_.push_back(back);
  order_.insert(order_.end(), nearest_.begin(), nearest_.end());
  ends_.push_back(order_.size());
  is_cut_.push_back(has_farther_);
}

}  // namespace kairos
