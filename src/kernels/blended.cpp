#include "kernels/blended.h"

#include <algorithm>
#include <tuple>

#include "kernels/time_bins.h"

namespace kairos {

namespace {

float distance(const Segment& s, float time) {
  if (time == s.end) return s.dist_end;
  return s.dist_begin + (s.dist_end - s.dist_begin) * ((time - s.begin) / s.duration());
}

/// Adds the stretch in which `hit` is in front of `surface`, if there is one: two straight lines, so there is one at
/// most.
void add_hidden(const Segment& surface, const Segment& hit, std::vector<BlendedScratch::Stretch>& hidden) {
  float begin = std::max(surface.begin, hit.begin), end = std::min(surface.end, hit.end);
  if (!(begin < end)) return;
  const float first = distance(surface, begin) - distance(hit, begin),
              last = distance(surface, end) - distance(hit, end);
  if (first == 0 && last == 0) {
    if (std::tie(hit.mesh, hit.triangle) < std::tie(surface.mesh, surface.triangle)) hidden.push_back({begin, end});
    return;
  }
  if (first <= 0 && last <= 0) return;
  if (first < 0 || last < 0) {
    const float crossing = std::clamp(begin + (end - begin) * (first / (first - last)), begin, end);
    (first < 0 ? begin : end) = crossing;
  }
  hidden.push_back({begin, end});
}

}  // namespace

void clip_blended(const std::vector<Segment>& blended, const std::vector<Segment>& opaque, BlendedScratch& scratch,
                  std::vector<Segment>& out) {
  out.clear();
  if (blended.empty()) return;
  auto& hits = scratch.in_time_order;
  hits = opaque;
  std::sort(hits.begin(), hits.end(), [](const Segment& a, const Segment& b) { return a.begin < b.begin; });
  for (const Segment& surface : blended) {
    auto& hidden = scratch.hidden;
    hidden.clear();
    for (const Segment& hit : hits) {
      if (hit.begin >= surface.end) break;
      add_hidden(surface, hit, hidden);
    }
    std::sort(hidden.begin(), hidden.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    float begin = surface.begin;
    const auto keep_until = [&](float end) {
      if (end - begin < kTimeSnap) return;
      Segment part = surface;
      part.begin = begin;
      part.end = end;
      part.dist_begin = distance(surface, begin);
      part.dist_end = distance(surface, end);
      out.push_back(part);
    };
    for (const auto& stretch : hidden) {
      keep_until(stretch.begin);
      begin = std::max(begin, stretch.end);
    }
    keep_until(surface.end);
  }
  std::sort(out.begin(), out.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.begin, a.mesh, a.triangle, a.dist_begin) < std::tie(b.begin, b.mesh, b.triangle, b.dist_begin);
  });
}

}  // namespace kairos
