// Traversal of moving geometry by a packet of rays. Compiled once per instruction set; see trace_simd.cpp.

#if defined(KAIROS_PACKET_COLLECTOR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_PACKET_COLLECTOR_INL_H
#undef KAIROS_PACKET_COLLECTOR_INL_H
#else
#define KAIROS_PACKET_COLLECTOR_INL_H
#endif

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include <hwy/highway.h>

#include "kernels/packet_test-inl.h"
#include "kernels/placed-inl.h"
#include "kernels/time_bins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// Visits what any of the rays may see; each ray has its own list of hits and its own time bins.
class PacketCollector {
 public:
  /// states: one per ray of the packet, begun. What they already know to be hidden is not visited.
  PacketCollector(const RayPacket& packet, std::span<RayState> states)
      : packet_(packet), slabs_(packet), states_(states), clips_(states[0].clips()) {
    std::fill_n(visible_until_, kPacketLanes, std::numeric_limits<float>::infinity());
  }

  void Collect(const Accel& accel) {
    UpdateBins();
    StackEntry* const bottom = states_[0].stack.data();
    if (accel.moving.root != kNoNode) {
      MovingSource source(accel.moving);
      Walk(source, {accel.moving.root, 0, 0, 1}, bottom);
    }
    if (accel.moving_instances.root == kNoNode) return;
    WalkInstances(
        accel.moving_instances, slabs_, bottom, states_[0].counters,
        [&](StackEntry& entry) HWY_ATTR {
          float visible_until;
          return clips_ && !ClipEntry(bins_, entry, visible_until);
        },
        [&](const Instance& instance, const StackEntry& entry, StackEntry* top) HWY_ATTR {
          PlacedMovingSource source(accel, instance);
          for (uint32_t span = 0; span < source.Spans(); ++span) {
            StackEntry root{source.Root(), entry.dist, entry.begin, entry.end};
            if (source.EnterSpan(span, root.begin, root.end)) Walk(source, root, top);
          }
          return true;
        });
  }

 private:
  /// Visits `first` and what is below it. bottom: from where on the stack may be used.
  template <class Source>
  HWY_INLINE void Walk(Source& source, const StackEntry& first, StackEntry* bottom) {
    StackEntry* top = bottom;
    *top++ = first;
    NodeHits node_hits;
    TraceCounters& counters = states_[0].counters;
    while (top != bottom) {
      StackEntry entry = *--top;
      float visible_until = std::numeric_limits<float>::infinity();
      if (clips_ && !ClipEntry(bins_, entry, visible_until)) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = source.NodeAt(entry.node);
        ++counters.nodes;
        TestNode(node, source.WindowsAt(entry.node), slabs_, entry.begin, entry.end, node_hits);
        top = PushChildren(node.child, node_hits, true, top);
        continue;
      }
      UpdateLimits(entry);
      source.ForEachSpan(entry.node, entry.begin, entry.end,
                         [&](const MovingBlock& block, const Span& span, uint32_t lanes, bool follows) KAIROS_INLINE {
                           if (block.spans == 1) {
                             PrepareTriangles(span, span.key0, span.key1, lanes, packet_, entry.begin, entry.end,
                                              visible_until, triangles_);
                           } else {
                             lanes &= framed_.Enter(span, follows,
                                                    [&](const BlockKey& key, PacketKey& framed)
                                                        HWY_ATTR { FrameKey(key, packet_, framed); });
                             if (lanes == 0) return;
                             PrepareTriangles(span, framed_.begin(), framed_.end(), lanes, packet_, entry.begin,
                                              entry.end, visible_until, triangles_);
                           }
                           counters.triangles += static_cast<uint64_t>(std::popcount(lanes));
                           if (packet_.rays_per_register == kPacketLanes)
                             TestCandidates<kPacketLanes>(block, span);
                           else
                             TestCandidates<kPacketLanes / 4>(block, span);
                         });
      UpdateBins();
    }
  }

  template <size_t kRays>
  HWY_INLINE void TestCandidates(const MovingBlock& block, const Span& span) {
    constexpr size_t kStep = kPacketLanes / kRays;  // triangles beside each other
    constexpr uint32_t kGroup = (1u << kStep) - 1;
    for (uint32_t left = triangles_.candidates; left != 0;) {
      const size_t first = static_cast<size_t>(std::countr_zero(left)) / kStep * kStep;
      left &= ~(kGroup << first);
      TestPacket<kRays>(triangles_, first, packet_, visible_until_, hits_);
      states_[0].counters.root_solves += 3 * static_cast<uint64_t>(std::popcount(hits_.solved));
      AddHits<kStep>(block, span, first);
    }
  }

  /// kStep, first: lane i is triangle first + i % kStep and ray i / kStep.
  template <size_t kStep>
  HWY_INLINE void AddHits(const MovingBlock& block, const Span& span, size_t first) {
    PlaceInShutter<kStep>(span, first);
    for (uint32_t mask = hits_.hit | hits_.rare; mask != 0; mask &= mask - 1) {
      const size_t lane = static_cast<size_t>(std::countr_zero(mask));
      const size_t triangle = first + lane % kStep;
      RayState& state = states_[lane / kStep];
      if (((hits_.rare | hits_.bent) >> lane & 1) != 0) {
        AddSlowly(block, span, lane, triangle, (hits_.rare >> lane & 1) != 0, state);
        bins_changed_ = true;
        continue;
      }
      const Segment hit{placed_.begin[lane],           placed_.end[lane],    hits_.dist_begin[lane],
                        hits_.dist_end[lane],          block.mesh[triangle], block.triangle[triangle],
                        (hits_.front >> lane & 1) != 0};
      if (!(hit.begin < hit.end) || !state.shows(hit)) continue;
      if (state.takes_whole(hit.mesh)) {
        bins_changed_ |= AddWhole(state, hit, static_cast<TimeBins::Mask>(placed_.touched[lane]),
                                  static_cast<TimeBins::Mask>(placed_.filled[lane]));
      } else {
        state.add(hit);
        bins_changed_ = true;
      }
    }
  }

  /// What of the hits can be computed for all lanes at once: times of the shutter, and the bins they touch and fill.
  template <size_t kStep>
  HWY_INLINE void PlaceInShutter(const Span& span, size_t first_triangle) {
    const hn::CappedTag<float, kPacketLanes> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    const V one = hn::Set(d, 1.0f), bins = hn::Set(d, static_cast<float>(TimeBins::kCount));
    const auto last_bin = hn::Set(di, TimeBins::kCount - 1), int_one = hn::Set(di, 1);
    const auto of_triangles = [&](const Row& row) HWY_ATTR {
      return kStep == 1 ? hn::Set(d, row.lane[first_triangle]) : hn::LoadDup128(d, row.lane + first_triangle);
    };
    const V span_begin = of_triangles(span.begin), span_end = of_triangles(span.end);
    const V length = hn::Sub(span_end, span_begin);
    for (size_t lane = 0; lane < kPacketLanes; lane += hn::Lanes(d)) {
      const auto to_shutter = [&](const float* times) HWY_ATTR {
        const V time = hn::Load(d, times + lane);
        return hn::IfThenElse(hn::Ge(time, one), span_end, hn::Add(span_begin, hn::Mul(time, length)));
      };
      const V begin = to_shutter(hits_.begin), end = to_shutter(hits_.end);
      // As TimeBins::touched and filled. Lanes without a hit hold anything: their bins are kept within the mask.
      const V from = hn::Mul(begin, bins), to = hn::Mul(end, bins);
      const auto in_range = [&](auto bin) HWY_ATTR { return hn::Max(hn::Min(bin, last_bin), hn::Zero(di)); };
      const auto first = in_range(hn::ConvertTo(di, from));
      const auto at_end = hn::ConvertTo(di, to);
      const auto is_bound = hn::RebindMask(di, hn::Eq(hn::ConvertTo(d, at_end), to));
      const auto last = in_range(hn::Sub(at_end, hn::IfThenElseZero(is_bound, int_one)));
      const auto after = hn::Add(last, int_one);
      const auto inner_first =
          hn::Add(first, hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(from, hn::ConvertTo(d, first))), int_one));
      const auto inner_after =
          hn::Add(last, hn::IfThenElseZero(hn::RebindMask(di, hn::Ge(to, hn::ConvertTo(d, after))), int_one));
      const auto bits = [&](auto low, auto high)
                            HWY_ATTR { return hn::Sub(hn::Shl(int_one, high), hn::Shl(int_one, low)); };
      hn::Store(begin, d, placed_.begin + lane);
      hn::Store(end, d, placed_.end + lane);
      hn::Store(bits(first, after), di, placed_.touched + lane);
      hn::Store(hn::IfThenElseZero(hn::Lt(inner_first, inner_after), bits(inner_first, inner_after)), di,
                placed_.filled + lane);
    }
  }

  HitInterval<float> HitAt(size_t lane) const {
    return {hits_.begin[lane], hits_.end[lane], hits_.dist_begin[lane], hits_.dist_end[lane],
            (hits_.front >> lane & 1) != 0};
  }

  /// As Collector::AddSlowly.
  HWY_NOINLINE void AddSlowly(const MovingBlock& block, const Span& span, size_t lane, size_t triangle, bool rare,
                              RayState& state) {
    std::array<Quadratic<float>, 3> edges;
    FramedTriangle<float> framed{};
    UnpackTriangle(triangles_, triangle, packet_, lane, edges, framed);
    const auto add = [&](const HitInterval<float>& hit) {
      add_in_pieces(state, framed, edges, hit, block.mesh[triangle], block.triangle[triangle],
                    span.begin.lane[triangle], span.end.lane[triangle],
                    [&](const Segment& piece) HWY_ATTR { AddHit(state, piece); });
    };
    if (!rare) return add(HitAt(lane));
    const HitIntervals<float> found = intersect_moving_triangle(framed, edges);
    for (size_t i = 0; i < static_cast<size_t>(found.count); ++i) add(found.hit[i]);
  }

  /// What is hidden for every ray.
  HWY_INLINE void UpdateBins() {
    if (!clips_ || !bins_changed_) return;
    bins_changed_ = false;
    bins_.set_to_farthest(states_[0].bins);
    for (size_t i = 1; i < states_.size(); ++i) bins_.widen_to(states_[i].bins);
  }

  /// How far each lane's ray sees while it is in a leaf.
  HWY_INLINE void UpdateLimits(const StackEntry& entry) {
    if (!clips_) return;
    const float begin = entry.begin - kTimeSnap, end = entry.end + kTimeSnap;
    const TimeBins::Mask touched = TimeBins::touched(std::max(begin, 0.0f), std::min(end, 1.0f));
    const size_t step = kPacketLanes / packet_.rays_per_register;
    for (size_t i = 0; i < states_.size(); ++i)
      std::fill_n(visible_until_ + i * step, step, VisibleUntil(states_[i].bins, touched));
  }

  const RayPacket& packet_;
  PacketSlabs slabs_;
  std::span<RayState> states_;
  bool clips_;
  TimeBins bins_;
  alignas(64) float visible_until_[kPacketLanes];  // [lane]
  FramedSpan<PacketKey> framed_;
  PacketTriangles triangles_;
  PacketHits hits_{};  // lanes without a hit are computed with, too
  struct alignas(64) {
    float begin[kPacketLanes], end[kPacketLanes];         // shutter time
    int32_t touched[kPacketLanes], filled[kPacketLanes];  // bins
  } placed_;                                              // of hits_
  bool bins_changed_ = true;                              // has any ray closed a bin since bins_ was made?
};

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
