// Lit colours for all that a pixel's rays see together: one list, evenly sampled.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/segment_shading.h"
#include "shading/shader.h"

namespace kairos {

/// Where shading is dear, and noisy by itself, what counts is how many samples there are in a pixel and how they are
/// spread, not that every triangle has one. So all segments of all rays are laid end to end, sorted by mesh, triangle
/// and time: neighbours in the list are about the same place at about the same time. Samples lie evenly along it, and
/// look at lights in the order of a Sobol' sequence, so that neighbours look at different places of them.
/// docs/method.md, "One list of all that a pixel sees".
///
/// One thread's scratch memory.
class ListedShading {
 public:
  explicit ListedShading(const Shader& shader) : shader_(shader) {}

  /// samples: per ray that sees something all the time. Appends the parts of all rays' segments to `out`, ray by ray,
  /// and for each ray to `ends` the number of parts after it: they cover exactly what its segments cover, and each is
  /// part of one of them, with its own normal and albedo where `out` keeps such; of the sky where pictures of it are
  /// seen. Returns the number of evaluations.
  uint64_t shade(std::span<const Ray> rays, std::span<const SeenByRay> seen, const TimeRange& window, double samples,
                 uint64_t pixel_seed, uint32_t first_ray, RecordBuilder& out, std::vector<uint32_t>& ends) {
    make_list(seen);
    const double rate = samples / (static_cast<double>(window.end) - static_cast<double>(window.begin));
    sky_rate_ = shader_.sky_varies() ? rate : 0;
    phase_ = unit_float(hash(pixel_seed, first_ray, kListPhase));
    const uint32_t count = list_.empty() ? 0 : static_cast<uint32_t>(std::max(1.0, std::round(rate * total_)));
    if (count > 0) take_samples(rays, count, hash(pixel_seed, kListDimension, first_ray));
    first_knot_ = out.add_knots(out.keeps_surfaces() ? 0 : count);
    if (!out.keeps_surfaces())
      for (uint32_t i = 0; i < count; ++i) out.set_knot(first_knot_ + i, queries_[i].time, shades_[i].colour, {}, {});
    hand_out(rays, seen, window, count, out, ends);
    return count;
  }

 private:
  static constexpr uint64_t kListDimension = 8, kListPhase = 9;  // beside those of other samples

  struct Entry {
    const Segment* segment;
    uint32_t ray, number;  // of the segment, counted ray by ray
    double before;         // what lies before it in the list, in shutter time
  };

  void make_list(std::span<const SeenByRay> seen) {
    list_.clear();
    uint32_t number = 0;
    for (uint32_t r = 0; r < seen.size(); ++r)
      for (const Segment& segment : seen[r].segments) list_.push_back({&segment, r, number++, 0});
    std::sort(list_.begin(), list_.end(), [](const Entry& a, const Entry& b) {
      const Segment &p = *a.segment, &q = *b.segment;
      if (p.mesh != q.mesh) return p.mesh < q.mesh;
      if (p.triangle != q.triangle) return p.triangle < q.triangle;
      if (p.begin != q.begin) return p.begin < q.begin;
      return a.number < b.number;
    });
    before_.resize(list_.size());
    total_ = 0;
    for (Entry& entry : list_) {
      before_[entry.number] = entry.before = total_;
      total_ += static_cast<double>(entry.segment->end) - static_cast<double>(entry.segment->begin);
    }
  }

  /// One in each of `count` equal stretches of the list, at the same fraction of all of them: anywhere with the same
  /// probability.
  void take_samples(std::span<const Ray> rays, uint32_t count, uint64_t seed) {
    queries_.clear();
    size_t at = 0;
    for (uint32_t i = 0; i < count; ++i) {
      const double place = total_ * ((i + static_cast<double>(phase_)) / count);
      while (at + 1 < list_.size() && list_[at + 1].before <= place) ++at;
      const Segment& segment = *list_[at].segment;
      // Half-open: at its very end something else is seen.
      const float latest = std::max(segment.begin, std::nextafter(segment.end, 0.0f));
      const float time =
          std::clamp(segment.begin + static_cast<float>(place - list_[at].before), segment.begin, latest);
      queries_.push_back({rays[list_[at].ray], segment.mesh, segment.triangle, time, 0, {seed, i}});
    }
    shades_.resize(count);
    shader_.shade(queries_, shades_);
  }

  /// Cuts segments where one stretch of the list ends and the next begins.
  void hand_out(std::span<const Ray> rays, std::span<const SeenByRay> seen, const TimeRange& window, uint32_t count,
                RecordBuilder& out, std::vector<uint32_t>& ends) const {
    const double per_sample = total_ / count;
    uint32_t number = 0;
    for (size_t r = 0; r < rays.size(); ++r) {
      float time = window.begin;
      for (const Segment& segment : seen[r].segments) {
        add_sky(rays[r], time, segment.begin, out);
        time = segment.end;
        const double before = before_[number++];
        auto sample = static_cast<uint32_t>(std::min(before / per_sample, static_cast<double>(count - 1)));
        for (float begin = segment.begin; begin < segment.end; ++sample) {
          const double cut = static_cast<double>(segment.begin) + ((sample + 1) * per_sample - before);
          const float end = sample + 1 == count ? segment.end : std::min(segment.end, static_cast<float>(cut));
          if (!(begin < end)) continue;
          out.add_part(part_of(segment, begin, end, knot(rays[r], segment, begin, end, sample, out)));
          begin = end;
        }
      }
      add_sky(rays[r], time, window.end, out);
      ends.push_back(out.part_count());
    }
  }

  /// Pictures of the sky, from `begin` to `end`: cheap, and so as often as a ray of its own would look.
  void add_sky(const Ray& ray, float begin, float end, RecordBuilder& out) const {
    if (!shader_.has_sky() || !(begin < end)) return;
    const double wanted = sky_rate_ * (static_cast<double>(end) - static_cast<double>(begin));
    const int parts = std::max(1, static_cast<int>(std::round(wanted)));
    const float length = end - begin;
    float from = begin;
    for (int part = 1; part <= parts; ++part) {
      const float to = part == parts ? end : begin + length * (static_cast<float>(part) / static_cast<float>(parts));
      if (!(from < to)) continue;
      const float time = std::min(from + (to - from) * phase_, std::max(from, std::nextafter(to, 0.0f)));
      const uint32_t sky = out.add_knot(time, shader_.sky(ray, time), {}, {});
      out.add_part({{from, to, INFINITY, INFINITY, kNoMesh, 0, false}, sky});
      from = to;
    }
  }

  uint32_t knot(const Ray& ray, const Segment& segment, float begin, float end, uint32_t sample,
                RecordBuilder& out) const {
    if (!out.keeps_surfaces()) return first_knot_ + sample;
    const float time = begin + (end - begin) * 0.5f;
    const Shade own = shader_.surface(ray, segment.mesh, segment.triangle, time);
    return out.add_knot(time, shades_[sample].colour, own.normal, own.albedo);
  }

  const Shader& shader_;
  std::vector<Entry> list_;
  std::vector<double> before_;  // [number of a segment]: what lies before it in the list
  double total_ = 0, sky_rate_ = 0;
  float phase_ = 0;
  std::vector<ShadingQuery> queries_;
  std::vector<Shade> shades_;
  uint32_t first_knot_ = 0;
};

}  // namespace kairos
