// From the visibility segments of a packet of rays to parts with colours: shared by the integrators that trace
// time-continuous rays.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "math/hash.h"
#include "pixel/record_builder.h"
#include "shading/listed_shading.h"
#include "shading/segment_shading.h"
#include "shading/shader.h"
#include "shading/spread.h"

namespace kairos {

/// One thread's scratch memory. docs/method.md, "Shading samples".
class PacketShading {
 public:
  /// look_ups: of lit pictures, see ListedShading. What is seen through blended surfaces is shaded at once all the
  /// same.
  PacketShading(const Shader& shader, const ShadingOptions& options, LookUps* look_ups = nullptr)
      : shader_(shader),
        options_(options),
        single_(shader, of_single_rays(shader, options)),
        listed_(shader, options.shadows, options.mirrors, look_ups) {}

  using Packet = TracedRays;

  /// Appends the parts of all rays' segments to `out`, ray by ray, and for each ray to `ends` the number of parts after
  /// it. The parts of a ray cover exactly what its segments cover, and each is part of one of them.
  void shade(const Packet& packet, RecordBuilder& out, std::vector<uint32_t>& ends) {
    const bool blended =
        std::any_of(packet.seen.begin(), packet.seen.end(), [](const SeenByRay& ray) { return !ray.blended.empty(); });
    if (options_.clusters == Clusters::pixel && !blended && (shader_.is_lit() || !shader_.has_sky())) {
      if (!shader_.is_lit()) return shade_together(packet, out, ends);
      evaluations_ += listed_.shade(packet, options_.samples, out, ends);
      return;
    }
    for (size_t i = 0; i < packet.rays.size(); ++i) {
      single_.shade(packet.rays[i], packet.seen[i].segments, packet.seen[i].blended, packet.window, packet.pixel_seed,
                    packet.first + static_cast<uint32_t>(i), packet.phases[i], out);
      ends.push_back(out.part_count());
    }
  }

  /// Those that shade() wants to find in a packet whose rays see no blended surfaces; null: none.
  const ExactShadows* packet_shadows() const {
    return shader_.is_lit() && options_.clusters == Clusters::pixel ? options_.shadows : nullptr;
  }

  uint64_t evaluations() const { return single_.evaluations() + evaluations_; }
  TraceCounters further_counters() const {  ///< of exact shadows and mirrors
    TraceCounters sum = listed_.further_counters();
    sum += single_.shadow_counters();
    return sum;
  }

 private:
  /// All that the packet's rays see of one triangle, laid end to end: ray by ray, in time order.
  struct Group {
    uint32_t mesh, triangle;
    float first, last;        ///< when it is seen first, and last
    uint32_t segments = 0;    ///< how many
    float time = 0;           ///< their durations' sum
    float passed = 0;         ///< of it, in a walk over all segments
    uint32_t parts = 1;       ///< equal ones, with a shading sample each
    uint32_t part = 0;        ///< in a walk: the next one
    uint32_t first_knot = 0;  ///< of parts
    float phase = 0;          ///< where in its part a sample lies

    float part_end(uint32_t index) const { return time * (static_cast<float>(index + 1) / static_cast<float>(parts)); }
  };

  /// Where a pixel's rays cannot be shaded together and shading is dear, clusters of a ray are the next best.
  static ShadingOptions of_single_rays(const Shader& shader, ShadingOptions options) {
    if (shader.is_lit() && options.clusters == Clusters::pixel) options.clusters = Clusters::on;
    return options;
  }

  void shade_together(const Packet& packet, RecordBuilder& out, std::vector<uint32_t>& ends) {
    group_by_triangle(packet);
    place_samples(packet, out);
    take_samples(packet, out);
    hand_out(packet, out, ends);
  }

  void group_by_triangle(const Packet& packet) {
    size_t count = 0;
    for (const SeenByRay& ray : packet.seen) count += ray.segments.size();
    const size_t slots = std::bit_ceil(2 * count + 1);
    slots_.assign(slots, kNone);
    groups_.clear();
    group_of_.clear();
    for (const SeenByRay& ray : packet.seen)
      for (const Segment& segment : ray.segments) {
        const uint64_t key = static_cast<uint64_t>(segment.mesh) << 32 | segment.triangle;
        size_t slot = static_cast<size_t>((key * kHashFactor) >> 32) & (slots - 1);
        while (slots_[slot] != kNone &&
               !(groups_[slots_[slot]].triangle == segment.triangle && groups_[slots_[slot]].mesh == segment.mesh))
          slot = (slot + 1) & (slots - 1);
        if (slots_[slot] == kNone) {
          slots_[slot] = static_cast<uint32_t>(groups_.size());
          groups_.push_back({segment.mesh, segment.triangle, segment.begin, segment.end});
        }
        Group& group = groups_[slots_[slot]];
        group.first = std::min(group.first, segment.begin);
        group.last = std::max(group.last, segment.end);
        group.time += segment.duration();
        ++group.segments;
        group_of_.push_back(slots_[slot]);
      }
  }

  /// To a group as many samples as are in proportion to its time and to how much its colours differ, and at least one.
  void place_samples(const Packet& packet, RecordBuilder& out) {
    const float samples =
        static_cast<float>(options_.samples) * kVariationScale / (packet.window.end - packet.window.begin);
    float phase = unit_float(hash(packet.pixel_seed, packet.first, kPhaseDimension));
    uint32_t samples_taken = 0;
    for (Group& group : groups_) {
      const float variation = shader_.variation(group.mesh, group.triangle, group.last - group.first);
      const float wanted = std::ceil(samples * variation * group.time);
      const float most = static_cast<float>(options_.samples) * static_cast<float>(group.segments);
      group.parts = static_cast<uint32_t>(std::clamp(wanted, 1.0f, most));
      group.first_knot = out.knot_count() + samples_taken;
      group.phase = phase;
      samples_taken += group.parts;
      phase += kGoldenShare;  // groups' samples lie at different fractions, spread evenly
      phase -= phase >= 1 ? 1.0f : 0.0f;
    }
    out.add_knots(samples_taken);
    evaluations_ += samples_taken;
  }

  /// Shades every part of every group at one instant of one of its segments.
  void take_samples(const Packet& packet, RecordBuilder& out) {
    SampleKey key{hash(packet.pixel_seed, kGroupDimension, packet.first), 0};
    auto index = group_of_.begin();
    for (size_t r = 0; r < packet.rays.size(); ++r)
      for (const Segment& segment : packet.seen[r].segments) {
        Group& group = groups_[*index++];
        const float passed = group.passed + segment.duration();
        const bool last = --group.segments == 0;  // takes what rounding has left over
        while (group.part < group.parts) {
          const float place =
              group.time * ((static_cast<float>(group.part) + group.phase) / static_cast<float>(group.parts));
          if (!last && place >= passed) break;
          // Half-open: at its very end something else is seen.
          const float latest = std::nextafter(segment.end, 0.0f);
          const float time = std::max(segment.begin, std::min(segment.begin + (place - group.passed), latest));
          const Shade shade = shader_.shade(packet.rays[r], segment.mesh, segment.triangle, time, key);
          ++key.index;
          out.set_knot(group.first_knot + group.part++, time, shade.colour, shade.normal, shade.albedo);
        }
        group.passed = passed;
      }
    for (Group& group : groups_) group.passed = group.part = 0;
  }

  void hand_out(const Packet& packet, RecordBuilder& out, std::vector<uint32_t>& ends) {
    auto index = group_of_.begin();
    for (size_t r = 0; r < packet.rays.size(); ++r) {
      for (const Segment& segment : packet.seen[r].segments) {
        Group& group = groups_[*index++];
        if (group.parts == 1) {
          out.add_part(part_of(segment, segment.begin, segment.end, group.first_knot));
          continue;
        }
        float begin = segment.begin;
        for (; group.part + 1 < group.parts; ++group.part) {
          const float end = segment.begin + (group.part_end(group.part) - group.passed);
          if (!(end < segment.end)) break;
          if (!(begin < end)) continue;
          out.add_part(part_of(segment, begin, end, group.first_knot + group.part));
          begin = end;
        }
        out.add_part(part_of(segment, begin, segment.end, group.first_knot + group.part));
        group.passed += segment.duration();
      }
      ends.push_back(out.part_count());
    }
  }

  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr uint64_t kHashFactor = 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
  /// Where colours differ by more than 1 / this, a group gets more samples than options_.samples for each ray that sees
  /// it all the time; where by less, fewer.
  static constexpr float kVariationScale = 4;
  static constexpr float kGoldenShare = 0.618034f;
  static constexpr uint64_t kPhaseDimension = 4, kGroupDimension = 6;  // beside those of single rays

  const Shader& shader_;
  ShadingOptions options_;
  SegmentShading single_;
  ListedShading listed_;
  std::vector<uint32_t> slots_;     // [hash]: number of a group
  std::vector<Group> groups_;       // in order of first sight
  std::vector<uint32_t> group_of_;  // [segment, ray by ray]
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
