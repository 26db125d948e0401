// Shading samples along a time-continuous ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <kairos/tracer.h>

namespace kairos {

/// A part of a segment, and the instant at which it is shaded: its duration is the sample's weight.
struct ShadingSample {
  uint32_t segment = 0;  ///< index of the segment it is part of
  float begin = 0, end = 0, time = 0;
};

/// Spreads `samples` shading samples over a ray's segments in proportion to their durations, at least one each. A
/// segment with n samples is cut into n equal parts, each sampled at the same fraction of its length; the parts'
/// durations sum to the segment's exactly.
///
/// varies(segment) says whether its instants may look different from each other: where not, one sample is exact.
/// share and phase, in [0, 1), independent of each other and uniform over rays: which segments get the samples that
/// durations leave undecided, and where in their parts samples lie. The sum of duration x colour(time) is then
/// unbiased.
template <class Varies>
void spread_samples(std::span<const Segment> segments, int samples, double share, float phase, Varies&& varies,
                    std::vector<ShadingSample>& out) {
  out.clear();
  double visible = 0, before = 0;
  for (const Segment& s : segments) visible += static_cast<double>(s.end) - static_cast<double>(s.begin);
  for (uint32_t i = 0; i < segments.size(); ++i) {
    const Segment& s = segments[i];
    const double after = before + (static_cast<double>(s.end) - static_cast<double>(s.begin));
    const double marks = std::floor(after / visible * samples + share) - std::floor(before / visible * samples + share);
    const int parts = varies(s) ? std::max(1, static_cast<int>(marks)) : 1;
    const auto border = [&](int part) {
      if (part == parts) return s.end;
      return std::min(s.end, s.begin + (s.end - s.begin) * (static_cast<float>(part) / static_cast<float>(parts)));
    };
    for (int part = 0; part < parts; ++part) {
      const float begin = border(part), end = border(part + 1);
      // Half-open: at its very end another triangle is seen.
      const float time = std::max(begin, std::min(begin + (end - begin) * phase, std::nextafter(s.end, 0.0f)));
      out.push_back({i, begin, end, time});
    }
    before = after;
  }
}

}  // namespace kairos
