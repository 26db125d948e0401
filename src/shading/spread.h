// Shading samples along a time-continuous ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <kairos/render.h>
#include <kairos/tracer.h>

#include "shading/time_grid.h"

namespace kairos {

class ExactMirrors;
class ExactShadows;

/// How time-continuous rays are shaded. See RenderParams.
struct ShadingOptions {
  double samples = 8;                ///< per ray, while the shutter is open
  Clusters clusters = Clusters::on;  ///< not automatic
  bool over_time = false;  ///< colours as functions of time, each at its own instants; not with Clusters::pixel
  TimeGrid grid{8};
  float contrast = 0, dark = 0;  ///< these and what follows: see RecordNeeds
  float looks_begin = 0, looks_end = 1;
  const ExactShadows* shadows = nullptr;  ///< with Clusters::pixel or a contrast alone; null: all are sampled
  const ExactMirrors* mirrors = nullptr;  ///< with Clusters::pixel alone, and without look-ups; null: none are exact
};
inline Clusters clusters_of(const RenderParams& params) {
  return params.clusters == Clusters::automatic ? Clusters::pixel : params.clusters;
}
/// Of a grid over the shutter.
inline constexpr double kMostCells = 1 << 16;

inline ShadingOptions shading_options(const Shot& shot, const RenderParams& params, const RecordNeeds& needs) {
  // As many in the shortest exposure, where colours are functions of time; elsewhere samples fill the pixel's window.
  const double cells_wanted = params.shading_samples / (params.exposure ? params.exposure->shortest() : 1);
  const auto cells = static_cast<uint32_t>(std::min(std::ceil(cells_wanted), kMostCells));
  const double open = shot.shutter_open, close = shot.shutter_close;
  const TimeGrid grid = params.shading_interval > 0 ? TimeGrid(open, close, params.shading_interval, cells)
                        : close > open              ? TimeGrid(open, close, close - open, cells)
                                                    : TimeGrid(cells);
  const double samples = params.shading_interval > 0 ? grid.count() : params.shading_samples;
  Clusters clusters = clusters_of(params);
  if (needs.over_time() && clusters == Clusters::pixel)
    clusters = Clusters::on;  // of a pixel's rays, at other instants
  return {samples, clusters, needs.over_time(), grid, needs.contrast, needs.dark, needs.looks_begin, needs.looks_end};
}

/// The end of the cluster that begins with segment `first`: of the longest run of segments that touch and of which
/// joined(segment, next) is true.
template <class Joined>
uint32_t end_of_cluster(std::span<const Segment> segments, uint32_t first, const Joined& joined) {
  uint32_t after = first + 1;
  while (after < segments.size() && segments[after].begin == segments[after - 1].end &&
         joined(segments[after - 1], segments[after]))
    ++after;
  return after;
}

/// A stretch of a cluster of segments, and the instant at which it is shaded: its duration is the sample's weight.
struct ShadingSample {
  uint32_t first = 0;    ///< index of the segment in which it begins; it may go on over the next ones
  uint32_t segment = 0;  ///< index of the segment in which `time` lies
  float begin = 0, end = 0, time = 0;
};

/// Spreads `samples` shading samples over a ray's segments in proportion to their durations, at least one for each
/// cluster: a longest run of segments that touch and of which joined(segment, next) is true. A cluster with n samples
/// is cut into n equal parts, each sampled at the same fraction of its length, whichever segment that falls into; the
/// parts' durations sum to the cluster's exactly.
///
/// varies(segment) says whether its instants may look different from each other; asked of the first of a cluster.
/// Where not, one sample stands for the cluster.
/// share and phase, in [0, 1), independent of each other and uniform over rays: which clusters get the samples that
/// durations leave undecided, and where in their parts samples lie. A sample is anywhere in its part with the same
/// probability, so the sum of duration x colour(time) is unbiased, whatever `joined` says.
template <class Joined, class Varies>
void spread_samples(std::span<const Segment> segments, double samples, double share, float phase, Joined&& joined,
                    Varies&& varies, std::vector<ShadingSample>& out) {
  out.clear();
  double visible = 0, before = 0;
  for (const Segment& s : segments) visible += static_cast<double>(s.end) - static_cast<double>(s.begin);
  const auto count = static_cast<uint32_t>(segments.size());
  for (uint32_t first = 0, next = 0; first < count; first = next) {
    next = end_of_cluster(segments, first, joined);
    const float cluster_begin = segments[first].begin, cluster_end = segments[next - 1].end;
    const double after = before + (static_cast<double>(cluster_end) - static_cast<double>(cluster_begin));
    const double marks = std::floor(after / visible * samples + share) - std::floor(before / visible * samples + share);
    const int parts = varies(segments[first]) ? std::max(1, static_cast<int>(marks)) : 1;
    const float length = cluster_end - cluster_begin;
    uint32_t begins_in = first, lies_in = first;
    float begin = cluster_begin;
    for (int part = 1; part <= parts; ++part) {
      const float share_of_length = static_cast<float>(part) / static_cast<float>(parts);
      const float end = part == parts ? cluster_end : std::min(cluster_end, cluster_begin + length * share_of_length);
      if (!(begin < end)) continue;  // too short for so many
      // Half-open: at its very end something else is seen.
      const float latest = std::nextafter(end, 0.0f);
      const float time = std::max(begin, std::min(begin + (end - begin) * phase, latest));
      while (segments[begins_in].end <= begin) ++begins_in;
      while (segments[lies_in].end <= time) ++lies_in;
      out.push_back({begins_in, lies_in, begin, end, time});
      begin = end;
    }
    before = after;
  }
}

}  // namespace kairos
