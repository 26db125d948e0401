// Lit colours for all that a pixel's rays see together: one list, evenly sampled.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/exact_shadows.h"
#include "shading/look_ups.h"
#include "shading/segment_shading.h"
#include "shading/shader.h"

namespace kairos {

/// Where shading is dear, and noisy by itself, what counts is how many samples there are in a pixel and how they are
/// spread, not that every triangle has one. So all segments of all rays are laid end to end, sorted by mesh, triangle
/// and time: neighbours in the list are about the same place at about the same time. Samples lie evenly along it, one
/// in each of as many equal stretches, and look at lights in the order of a Sobol' sequence, so that neighbours look at
/// different places of them. How far into its stretch a sample lies changes from ray's worth to ray's worth, evenly
/// spread: were it the same everywhere, rays that see one thing all the time would all see it at the same instants.
/// docs/method.md, "One list of all that a pixel sees". What shadows are exact on has a list of its own: its samples
/// leave out the light of which the shadows are, which each ray adds for itself, when it is there.
///
/// One thread's scratch memory.
class ListedShading {
 public:
  /// shadows: null where all are sampled.
  /// look_ups: where not null, takes the samples in place of the shader: knots get their colours later.
  explicit ListedShading(const Shader& shader, const ExactShadows* shadows = nullptr, LookUps* look_ups = nullptr)
      : shader_(shader), shadows_(shadows), look_ups_(look_ups) {}

  /// samples: per ray that sees something all the time. Appends the parts of all rays' segments to `out`, ray by ray,
  /// and for each ray to `ends` the number of parts after it: they cover exactly what its segments cover, and each is
  /// part of one of them, with its own normal and albedo where `out` keeps such; of the sky where pictures of it are
  /// seen. phases: see PacketShading::Packet. Returns the number of evaluations made.
  uint64_t shade(std::span<const Ray> rays, std::span<const SeenByRay> seen, std::span<const float> phases,
                 const TimeRange& window, double samples, uint64_t pixel_seed, uint32_t first_ray, RecordBuilder& out,
                 std::vector<uint32_t>& ends) {
    make_lists(seen);
    const double rate = samples / (static_cast<double>(window.end) - static_cast<double>(window.begin));
    sky_rate_ = shader_.sky_varies() ? rate : 0;
    phase_ = unit_float(hash(pixel_seed, first_ray, kListPhase));
    uint32_t count = 0;
    for (List& list : lists_) {
      list.first_sample = count;
      list.samples = list.total > 0 ? static_cast<uint32_t>(std::max(1.0, std::round(rate * list.total))) : 0;
      count += list.samples;
    }
    if (count > 0) take_samples(rays, phases, count, hash(pixel_seed, kListDimension, first_ray));
    first_knot_ = out.add_knots(out.keeps_surfaces() ? 0 : count);
    if (!out.keeps_surfaces())
      for (uint32_t i = 0; i < count; ++i) set_knot(out, first_knot_ + i, i);
    hand_out(rays, seen, window, out, ends);
    return look_ups_ == nullptr ? count : 0;
  }

  TraceCounters shadow_counters() const { return steps_.counters(); }

 private:
  static constexpr uint64_t kListDimension = 8, kListPhase = 9;  // beside those of other samples

  struct Entry {
    const Segment* segment;
    uint32_t ray, number;  // of the segment, counted ray by ray
    double before;         // what lies before it in its list, in shutter time
  };
  /// Stretches of shutter time, laid end to end.
  struct List {
    size_t begin = 0, end = 0;  // of its entries
    double total = 0;
    uint32_t first_sample = 0, samples = 0;
  };

  /// 1: exact shadows are on it.
  size_t list_of(uint32_t mesh) const { return shadows_ != nullptr && shadows_->on(mesh) ? 1 : 0; }

  void make_lists(std::span<const SeenByRay> seen) {
    entries_.clear();
    uint32_t number = 0;
    for (uint32_t r = 0; r < seen.size(); ++r)
      for (const Segment& segment : seen[r].segments) entries_.push_back({&segment, r, number++, 0});
    std::sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
      const Segment &p = *a.segment, &q = *b.segment;
      if (p.mesh != q.mesh) {
        const size_t in = list_of(p.mesh), other = list_of(q.mesh);
        return in != other ? in < other : p.mesh < q.mesh;
      }
      if (p.triangle != q.triangle) return p.triangle < q.triangle;
      if (p.begin != q.begin) return p.begin < q.begin;
      return a.number < b.number;
    });
    before_.resize(entries_.size());
    size_t at = 0;
    for (size_t l = 0; l < lists_.size(); ++l) {
      List& list = lists_[l] = {at, at, 0, 0, 0};
      for (; list.end < entries_.size() && list_of(entries_[list.end].segment->mesh) == l; ++list.end) {
        Entry& entry = entries_[list.end];
        before_[entry.number] = entry.before = list.total;
        list.total += static_cast<double>(entry.segment->end) - static_cast<double>(entry.segment->begin);
      }
      at = list.end;
    }
  }

  /// One in each of a list's equal stretches, anywhere in it with the same probability.
  void take_samples(std::span<const Ray> rays, std::span<const float> phases, uint32_t count, uint64_t seed) {
    queries_.clear();
    for (const List& list : lists_) {
      size_t at = list.begin;
      for (uint32_t i = 0; i < list.samples; ++i) {
        const auto phase = static_cast<double>(phases[static_cast<size_t>(i) * phases.size() / list.samples]);
        const double place = list.total * ((i + phase) / list.samples);
        while (at + 1 < list.end && entries_[at + 1].before <= place) ++at;
        const Segment& segment = *entries_[at].segment;
        // Half-open: at its very end something else is seen.
        const float latest = std::max(segment.begin, std::nextafter(segment.end, 0.0f));
        const float time =
            std::clamp(segment.begin + static_cast<float>(place - entries_[at].before), segment.begin, latest);
        queries_.push_back({rays[entries_[at].ray],
                            segment.mesh,
                            segment.triangle,
                            time,
                            look_ups_ == nullptr ? 0 : shader_.width_at(distance_at(segment, time)),
                            {seed, list.first_sample + i},
                            list_of(segment.mesh) == 1 ? RestingLights::left_out : RestingLights::as_is});
      }
    }
    if (look_ups_ == nullptr) {
      shades_.resize(count);
      shader_.shade(queries_, shades_);
    } else {
      first_look_up_ = look_ups_->count();
      for (const ShadingQuery& query : queries_) look_ups_->add(query);
      shades_.assign(count, {});
    }
  }

  /// Of a sample, without normal and albedo.
  void set_knot(RecordBuilder& out, uint32_t knot, uint32_t sample) {
    out.set_knot(knot, queries_[sample].time, shades_[sample].colour, {}, {});
    wait(knot, sample);
  }
  /// A knot with a sample's colour, or what is to be added to it.
  uint32_t add_knot(RecordBuilder& out, float time, Vec3f colour, const Shade& own, uint32_t sample) {
    const uint32_t knot = out.add_knot(time, colour, own.normal, own.albedo);
    wait(knot, sample);
    return knot;
  }
  void wait(uint32_t knot, uint32_t sample) {
    if (look_ups_ != nullptr) look_ups_->link(knot, first_look_up_ + sample);
  }

  /// Cuts segments where one stretch of their list ends and the next begins.
  void hand_out(std::span<const Ray> rays, std::span<const SeenByRay> seen, const TimeRange& window, RecordBuilder& out,
                std::vector<uint32_t>& ends) {
    uint32_t number = 0;
    for (size_t r = 0; r < rays.size(); ++r) {
      float time = window.begin;
      uint32_t looked_mesh = kNoMesh, looked_triangle = 0;
      for (const Segment& segment : seen[r].segments) {
        add_sky(rays[r], time, segment.begin, out);
        time = segment.end;
        const bool exact = list_of(segment.mesh) == 1;
        if (exact && (segment.mesh != looked_mesh || segment.triangle != looked_triangle)) {
          steps_.look(*shadows_, rays[r], segment.mesh, segment.triangle, window);
          looked_mesh = segment.mesh;
          looked_triangle = segment.triangle;
        }
        const List& list = lists_[exact ? 1 : 0];
        const double before = before_[number++], per_sample = list.total / list.samples;
        auto sample = static_cast<uint32_t>(std::min(before / per_sample, static_cast<double>(list.samples - 1)));
        for (float begin = segment.begin; begin < segment.end; ++sample) {
          const double cut = static_cast<double>(segment.begin) + ((sample + 1) * per_sample - before);
          const float end = sample + 1 == list.samples ? segment.end : std::min(segment.end, static_cast<float>(cut));
          if (!(begin < end)) continue;
          if (exact)
            add_steps(rays[r], segment, begin, end, list.first_sample + sample, out);
          else
            out.add_part(part_of(segment, begin, end, knot(rays[r], segment, begin, end, sample, out)));
          begin = end;
        }
      }
      add_sky(rays[r], time, window.end, out);
      ends.push_back(out.part_count());
    }
  }

  /// A sample's stretch of a segment with exact shadows on it: cut where these change.
  void add_steps(const Ray& ray, const Segment& segment, float begin, float end, uint32_t sample, RecordBuilder& out) {
    for (const auto& step : steps_.steps()) {
      if (!(step.end > begin)) continue;
      const float until = std::min(end, step.end), middle = begin + (until - begin) * 0.5f;
      const Vec3f sum = shades_[sample].colour + step.light;
      const Vec3f colour = look_ups_ == nullptr ? shader_.limited(sum) : sum;
      const Shade own = out.keeps_surfaces() ? shader_.surface(ray, segment.mesh, segment.triangle, middle) : Shade{};
      out.add_part(part_of(segment, begin, until, add_knot(out, middle, colour, own, sample)));
      begin = until;
      if (!(begin < end)) return;
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

  uint32_t knot(const Ray& ray, const Segment& segment, float begin, float end, uint32_t sample, RecordBuilder& out) {
    if (!out.keeps_surfaces()) return first_knot_ + sample;
    const float time = begin + (end - begin) * 0.5f;
    const Shade own = shader_.surface(ray, segment.mesh, segment.triangle, time);
    return add_knot(out, time, shades_[sample].colour, own, sample);
  }

  const Shader& shader_;
  const ExactShadows* const shadows_;
  LookUps* const look_ups_;
  uint32_t first_look_up_ = 0;  // of the pixel's samples
  std::vector<Entry> entries_;  // list by list
  std::array<List, 2> lists_;
  std::vector<double> before_;  // [number of a segment]: what lies before it in its list
  double sky_rate_ = 0;
  float phase_ = 0;
  std::vector<ShadingQuery> queries_;
  std::vector<Shade> shades_;
  RestingLightSteps steps_;
  uint32_t first_knot_ = 0;
};

}  // namespace kairos
