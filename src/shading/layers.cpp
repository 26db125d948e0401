#include "shading/layers.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include <kairos/record.h>

namespace kairos {

namespace {

// Cuts closer than this, in shutter time, are one: what rounding leaves between a segment's end and the next begin.
constexpr float kSliver = 1e-6f;

bool same_surface(const Segment& a, const Segment& b) {
  return a.mesh == b.mesh && a.triangle == b.triangle && a.front == b.front;
}

}  // namespace

void Layers::find_cuts(std::span<const Segment> segments, std::span<const Segment> blended) {
  cuts_.assign({0, 1});
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
    if (cut - cuts_[kept - 1] >= kSliver) cuts_[kept++] = cut;
  cuts_.resize(kept);
  cuts_.back() = 1;
}

void Layers::build(std::span<const Segment> segments, std::span<const Segment> blended, bool fill_gaps) {
  stretches_.clear();
  ends_.clear();
  order_.clear();
  active_.clear();
  find_cuts(segments, blended);
  size_t seen = 0;
  uint32_t next = 0;  // of the blended surfaces
  for (size_t i = 0; i + 1 < cuts_.size(); ++i) {
    const float begin = cuts_[i], end = cuts_[i + 1], middle = 0.5f * (begin + end);
    while (seen < segments.size() && segments[seen].end <= middle) ++seen;
    while (next < blended.size() && blended[next].begin <= middle) active_.push_back(next++);
    active_.erase(
        std::remove_if(active_.begin(), active_.end(), [&](uint32_t index) { return blended[index].end <= middle; }),
        active_.end());
    const bool is_gap = seen == segments.size() || segments[seen].begin > middle;
    if (is_gap && active_.empty() && !fill_gaps) continue;
    std::sort(active_.begin(), active_.end(), [&](uint32_t a, uint32_t b) {
      const Segment &one = blended[a], &other = blended[b];
      return std::tuple(distance_at(one, middle), one.mesh, one.triangle, a) <
             std::tuple(distance_at(other, middle), other.mesh, other.triangle, b);
    });
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
    if (std::equal(last.begin(), last.end(), active_.begin(), active_.end(),
                   [&](uint32_t a, uint32_t b) { return same_surface(blended[a], blended[b]); })) {
      stretches_.back().end = back.end;
      stretches_.back().dist_end = back.dist_end;
      return;
    }
  }
  stretches_.push_back(back);
  order_.insert(order_.end(), active_.begin(), active_.end());
  ends_.push_back(order_.size());
}

}  // namespace kairos
