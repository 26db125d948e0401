#include "kernels/veils.h"

#include <algorithm>
#include <tuple>

#include "kernels/time_bins.h"

namespace kairos {

namespace {

float distance(const Segment& s, float time) {
  if (time == s.end) return s.dist_end;
  return s.dist_begin + (s.dist_end - s.dist_begin) * ((time - s.begin) / s.duration());
}

/// Adds the stretch in which `hit` is in front of `veil`, if there is one: two straight lines, so there is one at most.
void add_hidden(const Segment& veil, const Segment& hit, std::vector<VeilScratch::Stretch>& hidden) {
  float begin = std::max(veil.begin, hit.begin), end = std::min(veil.end, hit.end);
  if (!(begin < end)) return;
  const float first = distance(veil, begin) - distance(hit, begin), last = distance(veil, end) - distance(hit, end);
  if (first == 0 && last == 0) {
    if (std::tie(hit.mesh, hit.triangle) < std::tie(veil.mesh, veil.triangle)) hidden.push_back({begin, end});
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

void clip_veils(const std::vector<Segment>& veils, const std::vector<Segment>& opaque, VeilScratch& scratch,
                std::vector<Segment>& out) {
  out.clear();
  if (veils.empty()) return;
  auto& hits = scratch.in_time_order;
  hits = opaque;
  std::sort(hits.begin(), hits.end(), [](const Segment& a, const Segment& b) { return a.begin < b.begin; });
  for (const Segment& veil : veils) {
    auto& hidden = scratch.hidden;
    hidden.clear();
    for (const Segment& hit : hits) {
      if (hit.begin >= veil.end) break;
      add_hidden(veil, hit, hidden);
    }
    std::sort(hidden.begin(), hidden.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    float begin = veil.begin;
    const auto keep_until = [&](float end) {
      if (end - begin < kTimeSnap) return;
      Segment part = veil;
      part.begin = begin;
      part.end = end;
      part.dist_begin = distance(veil, begin);
      part.dist_end = distance(veil, end);
      out.push_back(part);
    };
    for (const auto& stretch : hidden) {
      keep_until(stretch.begin);
      begin = std::max(begin, stretch.end);
    }
    keep_until(veil.end);
  }
  std::sort(out.begin(), out.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.begin, a.mesh, a.triangle, a.dist_begin) < std::tie(b.begin, b.mesh, b.triangle, b.dist_begin);
  });
}

}  // namespace kairos
