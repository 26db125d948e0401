// Traversal of the accelerator with vector instructions: one source, compiled by Highway for each instruction set.

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "kernels/dispatch.h"
#include "kernels/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/trace_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/block_test-inl.h"
#include "kernels/node_test-inl.h"
#include "kernels/packet_collector-inl.h"
#include "kernels/still_packet-inl.h"
#include "kernels/time_bins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

template <class T>
class Collector {
 public:
  Collector(const Accel& accel, const Ray& ray, RayState& state)
      : accel_(accel), frame_(ray), slabs_(ray), state_(state) {}

  void Run() {
    if (accel_.still.root != kNoNode) CollectStill(accel_.still);
    if (accel_.moving.root != kNoNode && !state_.is_complete()) CollectMoving(accel_.moving);
  }

 private:
  /// The nearest hit, which hides what is behind it at all times; or all of them, where nothing is to be culled.
  HWY_INLINE void CollectStill(const StillTree& tree) {
    Segment nearest;
    nearest.dist_begin =
        state_.clips() ? state_.bins.visible_until(TimeBins::touched(0, 1)) : std::numeric_limits<float>::infinity();
    bool found = false;
    StackEntry* top = state_.stack.data();
    *top++ = {tree.root, 0, 0, 1};
    NodeHits node_hits;
    BlockHits<T> block_hits;
    while (top != state_.stack.data()) {
      const StackEntry entry = *--top;
      if (entry.dist > nearest.dist_begin) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = tree.nodes[entry.node];
        ++state_.counters.nodes;
        TestNode(node, slabs_, node_hits);
        top = PushChildren(node.child, node_hits, false, top);
        continue;
      }
      const auto& block = tree.blocks[entry.node & ~kLeafBit];
      state_.counters.triangles += block.count;
      TestBlock(block, frame_, nearest.dist_begin, block_hits);
      for (uint32_t mask = block_hits.hit; mask != 0; mask &= mask - 1) {
        const size_t lane = static_cast<size_t>(std::countr_zero(mask));
        const float dist = static_cast<float>(block_hits.dist_begin[lane]);
        const Segment hit{
            0, 1, dist, dist, block.mesh[lane], block.triangle[lane], (block_hits.front >> lane & 1) != 0};
        if (!state_.is_there(hit)) continue;
        if (state_.mode != RayMode::visible) {
          state_.add(hit);
          if (state_.is_complete()) return;
        } else if (dist < nearest.dist_begin ||
                   (dist == nearest.dist_begin &&
                    std::pair(hit.mesh, hit.triangle) < std::pair(nearest.mesh, nearest.triangle))) {
          nearest = hit;
          found = true;
        }
      }
    }
    if (found) state_.add(nearest);
  }

  HWY_INLINE void CollectMoving(const MovingTree& tree) {
    StackEntry* top = state_.stack.data();
    *top++ = {tree.root, 0, 0, 1};
    NodeHits node_hits;
    while (top != state_.stack.data()) {
      StackEntry entry = *--top;
      float visible_until = std::numeric_limits<float>::infinity();
      if (state_.clips() && !ClipEntry(state_.bins, entry, visible_until)) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = tree.nodes[entry.node];
        ++state_.counters.nodes;
        const ChildWindows* windows = tree.windows.empty() ? nullptr : &tree.windows[entry.node];
        TestNode(node, windows, slabs_, entry.begin, entry.end, node_hits);
        top = PushChildren(node.child, node_hits, true, top);
        continue;
      }
      CollectLeaf(tree, tree.blocks[entry.node & ~kLeafBit], entry, visible_until);
      if (state_.is_complete()) return;
    }
  }

  HWY_INLINE void CollectLeaf(const MovingTree& tree, const MovingBlock& block, const StackEntry& entry,
                              float visible_until) {
    BlockHits<T> hits;
    const Row* times = &tree.times[block.first_time];
    for (uint32_t s = 0; s < block.spans; ++s) {
      const uint32_t lanes = LanesInSpan(block, times + s, entry.begin, entry.end);
      if (lanes == 0) continue;
      const Span span(tree, block, s);
      state_.counters.triangles += static_cast<uint64_t>(std::popcount(lanes));
      TestBlock(span.key0, span.key1, lanes, frame_, visible_until, hits);
      state_.counters.root_solves += 3 * static_cast<uint64_t>(std::popcount(hits.solved));
      AddHits(block, span, hits);
    }
  }

  HWY_INLINE void AddHits(const MovingBlock& block, const Span& span, const BlockHits<T>& hits) {
    for (uint32_t mask = hits.hit | hits.rare; mask != 0; mask &= mask - 1) {
      const size_t lane = static_cast<size_t>(std::countr_zero(mask));
      if (((hits.rare | hits.bent) >> lane & 1) != 0) {
        AddSlowly(block, span, lane, (hits.rare >> lane & 1) != 0, hits);
        continue;
      }
      AddHit(state_, to_segment(HitAt(hits, lane), block.mesh[lane], block.triangle[lane], span.begin.lane[lane],
                                span.end.lane[lane]));
    }
  }

  static HitInterval<T> HitAt(const BlockHits<T>& hits, size_t lane) {
    return {hits.begin[lane], hits.end[lane], hits.dist_begin[lane], hits.dist_end[lane],
            (hits.front >> lane & 1) != 0};
  }

  /// Lanes with more than one interval, on both sides of the origin, or whose distance is far from linear.
  HWY_NOINLINE void AddSlowly(const MovingBlock& block, const Span& span, size_t lane, bool rare,
                              const BlockHits<T>& hits) {
    const FramedTriangle<T> framed = to_frame(frame_, span.triangle(lane));
    const auto edges = edge_functions(framed);
    const auto add = [&](const HitInterval<T>& hit) {
      add_in_pieces(state_, framed, edges, hit, block.mesh[lane], block.triangle[lane], span.begin.lane[lane],
                    span.end.lane[lane]);
    };
    if (!rare) {
      add(HitAt(hits, lane));
      return;
    }
    const HitIntervals<T> found = intersect_moving_triangle(framed);
    for (size_t i = 0; i < static_cast<size_t>(found.count); ++i) add(found.hit[i]);
  }

  const Accel& accel_;
  RayFrame<T> frame_;
  RaySlabs slabs_;
  RayState& state_;
};

void CollectFast(const Accel& accel, const Ray& ray, RayState& state) { Collector<float>(accel, ray, state).Run(); }
void CollectExact(const Accel& accel, const Ray& ray, RayState& state) { Collector<double>(accel, ray, state).Run(); }
void CollectPacket(const Accel& accel, const RayPacket& packet, std::span<RayState> states) {
  if (accel.still.root != kNoNode) StillPacketCollector(packet, states).Collect(accel.still);
  if (accel.moving.root != kNoNode) PacketCollector(packet, states).Collect(accel.moving);
}
void TestOneNode(const Node<kMovingKeys>& node, const Ray& ray, NodeHits& hits) {
  TestNode(node, nullptr, RaySlabs(ray), 0, 1, hits);
}
void TestOneBlock(const BlockKey& begin, const BlockKey& end, const Ray& ray, BlockHits<float>& hits) {
  constexpr uint32_t kAll = (1u << kWidth) - 1;
  TestBlock(begin, end, kAll, RayFrame<float>(ray), std::numeric_limits<float>::infinity(), hits);
}

constexpr Kernels kKernels{CollectFast, CollectExact, CollectPacket, TestOneNode, TestOneBlock};

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kairos {

namespace {

struct Compiled {
  InstructionSet set;
  int64_t target;  // Highway's bit for it
  const Kernels* kernels;
};

/// What Highway has compiled above: which ones depends on the processor family and on the compiler.
constexpr Compiled kCompiled[] = {
#if (HWY_TARGETS & HWY_SSE4) != 0
    {InstructionSet::sse4, HWY_SSE4, &N_SSE4::kKernels},
#endif
#if (HWY_TARGETS & HWY_AVX2) != 0
    {InstructionSet::avx2, HWY_AVX2, &N_AVX2::kKernels},
#endif
#if (HWY_TARGETS & HWY_AVX3) != 0
    {InstructionSet::avx512, HWY_AVX3, &N_AVX3::kKernels},
#endif
#if (HWY_TARGETS & HWY_NEON) != 0
    {InstructionSet::neon, HWY_NEON, &N_NEON::kKernels},
#endif
    {InstructionSet::scalar, 0, nullptr}};  // so that the list is never empty

}  // namespace

const Kernels* find_kernels(InstructionSet set) {
  static constexpr Kernels kScalarKernels{collect_hits_scalar, collect_hits_scalar, nullptr, nullptr, nullptr};
  if (set == InstructionSet::scalar) return &kScalarKernels;
  const int64_t here = hwy::SupportedTargets();
  for (const Compiled& compiled : kCompiled)
    if (compiled.set == set && (here & compiled.target) != 0) return compiled.kernels;
  return nullptr;
}

}  // namespace kairos
#endif
