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

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// Visits what any of the rays may see; each ray has its own list of hits and its own time bins.
class PacketCollector {
 public:
  /// states: one per ray of the packet, begun. What they already know to be hidden is not visited.
  PacketCollector(const RayPacket& packet, std::span<RayState> states)
      : packet_(packet), slabs_(packet), states_(states), culls_(states[0].culls()) {
    std::fill_n(visible_until_, kPacketLanes, std::numeric_limits<float>::infinity());
  }

  void Collect(const Tree<kMovingKeys>& tree) {
    UpdateBins();
    StackEntry* const bottom = states_[0].stack.data();
    StackEntry* top = bottom;
    *top++ = {tree.root, 0, 0, 1};
    NodeHits node_hits;
    TraceCounters& counters = states_[0].counters;
    while (top != bottom) {
      StackEntry entry = *--top;
      float visible_until = std::numeric_limits<float>::infinity();
      if (culls_ && !clip_entry(bins_, tree, entry, visible_until)) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = tree.nodes[entry.node];
        ++counters.nodes;
        TestNode(node, slabs_, entry.begin, entry.end, node_hits);
        top = PushChildren(node.child, node_hits, true, top);
        continue;
      }
      const auto& block = tree.blocks[entry.node & ~kLeafBit];
      counters.triangles += block.count;
      UpdateLimits(tree, entry);
      PrepareTriangles(block, packet_, entry.begin, entry.end, visible_until, triangles_);
      if (packet_.rays_per_register == kPacketLanes)
        TestCandidates<kPacketLanes>(tree, block);
      else
        TestCandidates<kPacketLanes / 4>(tree, block);
      UpdateBins();
    }
  }

 private:
  template <size_t kRays>
  HWY_INLINE void TestCandidates(const Tree<kMovingKeys>& tree, const TriangleBlock<kMovingKeys>& block) {
    constexpr size_t kStep = kPacketLanes / kRays;  // triangles beside each other
    constexpr uint32_t kGroup = (1u << kStep) - 1;
    for (uint32_t left = triangles_.candidates; left != 0;) {
      const size_t first = static_cast<size_t>(std::countr_zero(left)) / kStep * kStep;
      left &= ~(kGroup << first);
      TestPacket<kRays>(triangles_, first, packet_, visible_until_, hits_);
      states_[0].counters.root_solves += 3 * static_cast<uint64_t>(std::popcount(hits_.solved));
      for (uint32_t mask = hits_.hit | hits_.rare; mask != 0; mask &= mask - 1) {
        const size_t lane = static_cast<size_t>(std::countr_zero(mask));
        Add(tree, block, lane, first + lane % kStep, states_[lane / kStep]);
      }
    }
  }

  HWY_INLINE void Add(const Tree<kMovingKeys>& tree, const TriangleBlock<kMovingKeys>& block, size_t lane,
                      size_t triangle, RayState& state) {
    const bool rare = (hits_.rare >> lane & 1) != 0;
    if (rare || (hits_.bent >> lane & 1) != 0) return AddSlowly(tree, block, lane, triangle, rare, state);
    state.add(to_segment(HitAt(lane), block.mesh[triangle], block.triangle[triangle], tree.time_begin, tree.time_end));
  }

  HitInterval<float> HitAt(size_t lane) const {
    return {hits_.begin[lane], hits_.end[lane], hits_.dist_begin[lane], hits_.dist_end[lane],
            (hits_.front >> lane & 1) != 0};
  }

  /// As Collector::AddSlowly.
  HWY_NOINLINE void AddSlowly(const Tree<kMovingKeys>& tree, const TriangleBlock<kMovingKeys>& block, size_t lane,
                              size_t triangle, bool rare, RayState& state) {
    std::array<Quadratic<float>, 3> edges;
    FramedTriangle<float> framed{};
    UnpackTriangle(triangles_, triangle, packet_, lane, edges, framed);
    const auto add = [&](const HitInterval<float>& hit) {
      add_in_pieces(state, framed, edges, hit, block.mesh[triangle], block.triangle[triangle], tree.time_begin,
                    tree.time_end);
    };
    if (!rare) return add(HitAt(lane));
    const HitIntervals<float> found = intersect_moving_triangle(framed, edges);
    for (size_t i = 0; i < static_cast<size_t>(found.count); ++i) add(found.hit[i]);
  }

  /// What is hidden for every ray.
  HWY_INLINE void UpdateBins() {
    if (!culls_) return;
    bins_.set_to_farthest(states_[0].bins);
    for (size_t i = 1; i < states_.size(); ++i) bins_.widen_to(states_[i].bins);
  }

  /// How far each lane's ray sees while it is in a leaf.
  HWY_INLINE void UpdateLimits(const Tree<kMovingKeys>& tree, const StackEntry& entry) {
    if (!culls_) return;
    const float begin = to_shutter_time(entry.begin, tree.time_begin, tree.time_end) - kTimeSnap;
    const float end = to_shutter_time(entry.end, tree.time_begin, tree.time_end) + kTimeSnap;
    const size_t step = kPacketLanes / packet_.rays_per_register;
    for (size_t i = 0; i < states_.size(); ++i) {
      const float limit = states_[i].bins.visible_until(std::max(begin, 0.0f), std::min(end, 1.0f));
      std::fill_n(visible_until_ + i * step, step, limit);
    }
  }

  const RayPacket& packet_;
  PacketSlabs slabs_;
  std::span<RayState> states_;
  bool culls_;
  TimeBins bins_;
  alignas(64) float visible_until_[kPacketLanes];  // [lane]
  PacketTriangles triangles_;
  PacketHits hits_;
};

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
