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
#include "shading/exact_mirrors.h"
#include "shading/exact_shadows.h"
#include "shading/look_ups.h"
#include "shading/packet_shadows.h"
#include "shading/sample_lists.h"
#include "shading/segment_shading.h"
#include "shading/shader.h"
#include "shading/step_sum.h"

namespace kairos {

/// The rays of a pixel that are shaded together, as they were traced together.
struct TracedRays {
  std::span<const Ray> rays;
  std::span<const SeenByRay> seen;
  std::span<const float> phases;  ///< one per ray, see spread_samples
  uint64_t pixel_seed;
  uint32_t first;      ///< number of the first ray within its pixel
  TimeRange window{};  ///< that of the rays
  /// Of the packet in which they were traced, where the first of them is its ray number `first_exact`. Null: nothing is
  /// known yet of exact shadows.
  const PacketShadows* exact_shadows = nullptr;
  size_t first_exact = 0;
};

/// Where shading is dear, and noisy by itself, what counts is how many samples there are in a pixel and how they are
/// spread, not that every triangle has one. So all segments of all rays are laid end to end, see SampleLists:
/// neighbours are about the same place at about the same time. Samples lie evenly along it, one in each of as many
/// equal stretches, and look at lights in the order of a Sobol' sequence, so that neighbours look at different places
/// of them. How far into its stretch a sample lies changes from ray's worth to ray's worth, evenly spread: were it the
/// same everywhere, rays that see one thing all the time would all see it at the same instants. See
/// docs/method.md, "One list of all that a pixel sees". Samples of what shadows are exact on leave out the light of
/// which the shadows are, which each ray adds for itself, when it is there. Those of mirrors that are exact leave out
/// what they show: that is in the lists by itself, and each ray adds up what it sees at the same time.
///
/// One thread's scratch memory.
class ListedShading {
 public:
  /// shadows: null where all are sampled; mirrors: null where none are exact.
  /// look_ups: where not null, takes the samples in place of the shader: knots get their colours later. Not with
  /// mirrors.
  explicit ListedShading(const Shader& shader, const ExactShadows* shadows = nullptr,
                         const ExactMirrors* mirrors = nullptr, LookUps* look_ups = nullptr)
      : shader_(shader), shadows_(shadows), mirrors_(mirrors), look_ups_(look_ups) {}

  /// samples: per ray that sees something all the time. Appends the parts of all rays' segments to `out`, ray by ray,
  /// and for each ray to `ends` the number of parts after it: they cover exactly what its segments cover, and each is
  /// part of one of them, with its own normal and albedo where `out` keeps such; of the sky where pictures of it are
  /// seen. Returns the number of evaluations made.
  uint64_t shade(const TracedRays& traced, double samples, RecordBuilder& out, std::vector<uint32_t>& ends) {
    const auto& [rays, seen, phases, pixel_seed, first_ray, window, exact_shadows, first_exact] = traced;
    make_lists(rays, seen, samples / (static_cast<double>(window.end) - static_cast<double>(window.begin)));
    sky_rate_ = shader_.sky_varies() ? samples / static_cast<double>(window.end - window.begin) : 0;
    phase_ = unit_float(hash(pixel_seed, first_ray, kListPhase));
    const uint32_t count = lists_.count();
    if (count > 0) take_samples(rays, phases, hash(pixel_seed, kListDimension, first_ray));
    first_knot_ = out.add_knots(out.keeps_surfaces() ? 0 : count);
    if (!out.keeps_surfaces())
      for (uint32_t i = 0; i < lists_.before_mirrors(); ++i) set_knot(out, first_knot_ + i, i);
    hand_out(traced, out, ends);
    return look_ups_ == nullptr ? count : 0;
  }

  TraceCounters further_counters() const {  ///< of exact shadows and mirrors
    TraceCounters sum = steps_.counters();
    sum += sights_.counters();
    return sum;
  }

 private:
  static constexpr uint64_t kListDimension = 8, kListPhase = 9;  // beside those of other samples

  SampleLists::Kind kind_of(uint32_t mesh) const {
    if (mirrors_ != nullptr && mirrors_->on(mesh)) return SampleLists::mirrors;
    return shadows_ != nullptr && shadows_->on(mesh) ? SampleLists::with_shadows : SampleLists::plain;
  }

  bool rests(uint32_t mesh) const { return shader_.shot().meshes[mesh].is_static(); }

  void make_lists(std::span<const Ray> rays, std::span<const SeenByRay> seen, double rate) {
    lists_.clear();
    sights_.clear();
    mirrors_seen_.clear();
    for (uint32_t r = 0; r < seen.size(); ++r)
      for (const Segment& segment : seen[r].segments) {
        const SampleLists::Kind kind = kind_of(segment.mesh);
        float weight = 1;
        if (kind == SampleLists::mirrors) {
          weight = sights_.follow(*mirrors_, rays[r], segment);
          mirrors_seen_.push_back({weight, sights_.all().size()});
        }
        lists_.add(segment, kind, r, nullptr, weight, rests(segment.mesh));
      }
    straight_ = lists_.size();
    for (const MirrorSights::Sight& sight : sights_.all())
      for (const MirrorSights::Seen& in : sights_.seen_on(sight)) {
        const bool is_mirror = kind_of(in.segment.mesh) == SampleLists::mirrors;
        lists_.add(in.segment, is_mirror ? SampleLists::mirrors : SampleLists::in_mirrors, 0, &sight, in.weight,
                   rests(in.segment.mesh));
      }
    lists_.lay(rate);
  }

  void take_samples(std::span<const Ray> rays, std::span<const float> phases, uint64_t seed) {
    queries_.clear();
    tints_.clear();
    lists_.visit_samples(phases, [&](const SampleLists::Entry& entry, float time) {
      const Segment& segment = *entry.segment;
      const SampleKey key{seed, static_cast<uint32_t>(queries_.size())};
      if (entry.kind >= SampleLists::mirrors) {
        queries_.push_back(mirrored_query(entry, rays, time, key));
        const Vec3f share = entry.sight != nullptr ? entry.sight->share : Vec3f{1, 1, 1};
        tints_.push_back(share * static_cast<float>(1 / entry.weight));
        return;
      }
      queries_.push_back({rays[entry.ray], segment.mesh, segment.triangle, time,
                          look_ups_ == nullptr ? 0 : shader_.width_at(distance_at(segment, time)), key,
                          entry.kind == SampleLists::with_shadows ? RestingLights::left_out : RestingLights::as_is});
    });
    if (look_ups_ == nullptr) {
      const uint32_t straight = lists_.before_mirrors();
      shades_.resize(straight);
      shader_.shade(std::span(queries_).first(straight), shades_);
      colours_.resize(tints_.size());
      if (!colours_.empty()) shader_.lit().radiance(std::span(queries_).subspan(straight), colours_);
      for (size_t i = 0; i < colours_.size(); ++i) colours_[i] = tints_[i] * colours_[i];
    } else {
      first_look_up_ = look_ups_->count();
      for (const ShadingQuery& query : queries_) look_ups_->add(query);
      shades_.assign(queries_.size(), {});
    }
  }

  /// Of a sample of a mirror, or of what it shows.
  ShadingQuery mirrored_query(const SampleLists::Entry& entry, std::span<const Ray> rays, float time,
                              SampleKey key) const {
    const MirrorSights::Sight* sight = entry.sight;
    const Segment& segment = *entry.segment;
    const float dist = distance_at(segment, time);
    const double width = sight != nullptr ? shader_.width_beyond(sight->width, dist) : shader_.width_at(dist);
    ShadingQuery query{
        sight != nullptr ? sight->ray : rays[entry.ray], segment.mesh, segment.triangle, time, width, key};
    if (sight != nullptr) {
      query.depth = sight->depth;
      query.weight = sight->weight;
    }
    if (mirrors_->on(segment.mesh)) query.followed_elsewhere = kLeastExact;
    return query;
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
  void hand_out(const TracedRays& traced, RecordBuilder& out, std::vector<uint32_t>& ends) {
    const auto& rays = traced.rays;
    const TimeRange& window = traced.window;
    uint32_t number = 0;
    next_mirror_ = next_sight_ = 0;
    next_in_mirrors_ = straight_;
    for (size_t r = 0; r < rays.size(); ++r) {
      float time = window.begin;
      uint32_t looked_mesh = kNoMesh, looked_triangle = 0;
      std::span<const RestingLightSteps::Step> steps;
      for (const Segment& segment : traced.seen[r].segments) {
        add_sky(rays[r], time, segment.begin, out);
        time = segment.end;
        const SampleLists::Kind kind = kind_of(segment.mesh);
        if (kind == SampleLists::mirrors) {
          add_mirror(rays[r], segment, number++, out);
          continue;
        }
        const bool exact = kind == SampleLists::with_shadows;
        if (exact && (segment.mesh != looked_mesh || segment.triangle != looked_triangle)) {
          if (traced.exact_shadows != nullptr)
            steps = traced.exact_shadows->steps(traced.first_exact + r, segment.mesh, segment.triangle);
          if (traced.exact_shadows == nullptr || steps.empty()) {
            steps_.look(*shadows_, rays[r], segment.mesh, segment.triangle, window);
            steps = steps_.steps();
          }
          looked_mesh = segment.mesh;
          looked_triangle = segment.triangle;
        }
        lists_.visit_stretches(number++, [&](float begin, float end, uint32_t sample) {
          if (exact)
            add_steps(rays[r], segment, steps, begin, end, sample, out);
          else
            out.add_part(part_of(segment, begin, end, knot(rays[r], segment, begin, end, sample, out)));
        });
      }
      add_sky(rays[r], time, window.end, out);
      ends.push_back(out.part_count());
    }
  }

  /// What a mirror is by itself, and what it shows.
  void add_mirror(const Ray& ray, const Segment& segment, uint32_t number, RecordBuilder& out) {
    const MirrorSeen& mirror = mirrors_seen_[next_mirror_++];
    sum_.clear();
    add_mirrored(number, mirror.own);
    for (; next_sight_ < mirror.end_of_sights; ++next_sight_) {
      const MirrorSights::Sight& sight = sights_.all()[next_sight_];
      float time = sight.begin;
      const auto add_beyond = [&](float until) {
        if (time < until) sum_.add(time, until, sight.share * shader_.lit().beyond(sight.ray, time));
      };
      for (const MirrorSights::Seen& in : sights_.seen_on(sight)) {
        add_beyond(in.segment.begin);
        time = in.segment.end;
        add_mirrored(next_in_mirrors_++, in.weight);
      }
      add_beyond(sight.end);
    }
    sum_.visit(segment.begin, segment.end, [&](float begin, float end, Vec3f colour) {
      const float middle = begin + (end - begin) * 0.5f;
      const Shade own = out.keeps_surfaces() ? shader_.surface(ray, segment.mesh, segment.triangle, middle) : Shade{};
      out.add_part(part_of(segment, begin, end, out.add_knot(middle, shader_.limited(colour), own.normal, own.albedo)));
    });
  }

  void add_mirrored(uint32_t number, float weight) {
    lists_.visit_stretches(number, [&](float begin, float end, uint32_t sample) {
      sum_.add(begin, end, colours_[sample - lists_.before_mirrors()] * weight);
    });
  }

  /// A sample's stretch of a segment with exact shadows on it: cut where these change.
  void add_steps(const Ray& ray, const Segment& segment, std::span<const RestingLightSteps::Step> steps, float begin,
                 float end, uint32_t sample, RecordBuilder& out) {
    for (const auto& step : steps) {
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
  const ExactMirrors* const mirrors_;
  LookUps* const look_ups_;
  uint32_t first_look_up_ = 0;  // of the pixel's samples
  SampleLists lists_;
  double sky_rate_ = 0;
  float phase_ = 0;
  std::vector<ShadingQuery> queries_;
  std::vector<Shade> shades_;           // of what is seen straight
  std::vector<Vec3f> tints_, colours_;  // of what mirrors show, if their weight were 1
  RestingLightSteps steps_;
  MirrorSights sights_;
  StepSum sum_;
  uint32_t straight_ = 0;  // segments
  struct MirrorSeen {
    float own;  // weight of its own light
    size_t end_of_sights;
  };
  std::vector<MirrorSeen> mirrors_seen_;     // [segment of a mirror, in order]
  size_t next_mirror_ = 0, next_sight_ = 0;  // in a walk over all segments
  uint32_t next_in_mirrors_ = 0;
  uint32_t first_knot_ = 0;
};

}  // namespace kairos
