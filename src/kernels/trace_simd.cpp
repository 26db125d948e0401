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
#include "kernels/placed-inl.h"
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
    CollectStill();
    if (accel_.moving.root != kNoNode && !state_.is_complete()) {
      MovingSource source(accel_.moving);
      WalkMoving(source, {accel_.moving.root, 0, 0, 1}, state_.stack.data());
    }
    if (accel_.moving_instances.root != kNoNode && !state_.is_complete()) CollectMovingInstances();
  }

 private:
  /// The nearest hit, which hides what is behind it at all times; or all of them, where nothing is to be culled.
  HWY_INLINE void CollectStill() {
    nearest_.dist_begin =
        state_.clips() ? state_.bins.visible_until(TimeBins::touched(0, 1)) : std::numeric_limits<float>::infinity();
    if (accel_.still.root != kNoNode) {
      StillSource source(accel_.still);
      WalkStill(source, {accel_.still.root, 0, 0, 1}, state_.stack.data());
    }
    if (accel_.still_instances.root != kNoNode && !state_.is_complete())
      WalkInstances(
          accel_.still_instances, slabs_, state_.stack.data(), state_.counters,
          [&](const StackEntry& entry) HWY_ATTR { return entry.dist > nearest_.dist_begin; },
          [&](const Instance& instance, const StackEntry& entry, StackEntry* top) HWY_ATTR {
            PlacedStillSource source(accel_, instance);
            WalkStill(source, {source.Root(), entry.dist, 0, 1}, top);
            return !state_.is_complete();
          });
    if (found_) state_.add(nearest_);
  }

  /// Visits `first` and what is below it. bottom: from where on the stack may be used.
  template <class Source>
  HWY_INLINE void WalkStill(Source& source, const StackEntry& first, StackEntry* bottom) {
    StackEntry* top = bottom;
    *top++ = first;
    NodeHits node_hits;
    BlockHits<T> block_hits;
    while (top != bottom) {
      const StackEntry entry = *--top;
      if (entry.dist > nearest_.dist_begin) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = source.NodeAt(entry.node);
        ++state_.counters.nodes;
        TestNode(node, slabs_, node_hits);
        top = PushChildren(node.child, node_hits, false, top);
        continue;
      }
      const auto& block = source.BlockAt(entry.node);
      state_.counters.triangles += block.count;
      TestBlock(block, frame_, nearest_.dist_begin, block_hits);
      for (uint32_t mask = block_hits.hit; mask != 0; mask &= mask - 1) {
        const size_t lane = static_cast<size_t>(std::countr_zero(mask));
        const float dist = static_cast<float>(block_hits.dist_begin[lane]);
        const Segment hit{
            0, 1, dist, dist, block.mesh[lane], block.triangle[lane], (block_hits.front >> lane & 1) != 0};
        if (!state_.is_there(hit)) continue;
        if (state_.mode != RayMode::visible) {
          state_.add(hit);
          if (state_.is_complete()) return;
        } else if (dist < nearest_.dist_begin ||
                   (dist == nearest_.dist_begin &&
                    std::pair(hit.mesh, hit.triangle) < std::pair(nearest_.mesh, nearest_.triangle))) {
          nearest_ = hit;
          found_ = true;
        }
      }
    }
  }

  HWY_INLINE void CollectMovingInstances() {
    WalkInstances(
        accel_.moving_instances, slabs_, state_.stack.data(), state_.counters,
        [&](StackEntry& entry) HWY_ATTR {
          float visible_until;
          return state_.clips() && !ClipEntry(state_.bins, entry, visible_until);
        },
        [&](const Instance& instance, const StackEntry& entry, StackEntry* top) HWY_ATTR {
          PlacedMovingSource source(accel_, instance);
          for (uint32_t span = 0; span < source.Spans(); ++span) {
            StackEntry root{source.Root(), entry.dist, entry.begin, entry.end};
            if (source.EnterSpan(span, root.begin, root.end)) WalkMoving(source, root, top);
          }
          return !state_.is_complete();
        });
  }

  template <class Source>
  HWY_INLINE void WalkMoving(Source& source, const StackEntry& first, StackEntry* bottom) {
    StackEntry* top = bottom;
    *top++ = first;
    NodeHits node_hits;
    while (top != bottom) {
      StackEntry entry = *--top;
      float visible_until = std::numeric_limits<float>::infinity();
      if (state_.clips() && !ClipEntry(state_.bins, entry, visible_until)) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = source.NodeAt(entry.node);
        ++state_.counters.nodes;
        TestNode(node, source.WindowsAt(entry.node), slabs_, entry.begin, entry.end, node_hits);
        top = PushChildren(node.child, node_hits, true, top);
        continue;
      }
      BlockHits<T> hits;
      source.ForEachSpan(entry.node, entry.begin, entry.end,
                         [&](const MovingBlock& block, const Span& span, uint32_t lanes, bool follows) KAIROS_INLINE {
                           if (block.spans == 1) {
                             TestBlock(span.key0, span.key1, lanes, frame_, visible_until, hits);
                           } else {
                             lanes &= framed_.Enter(span, follows,
                                                    [&](const BlockKey& key, FramedKey<T>& framed)
                                                        HWY_ATTR { FrameKey(key, frame_, framed); });
                             if (lanes == 0) return;
                             TestBlock(framed_.begin(), framed_.end(), lanes, frame_, visible_until, hits);
                           }
                           state_.counters.triangles += static_cast<uint64_t>(std::popcount(lanes));
                           state_.counters.root_solves += 3 * static_cast<uint64_t>(std::popcount(hits.solved));
                           AddHits(block, span, hits);
                         });
      if (state_.is_complete()) return;
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
                    span.end.lane[lane], [&](const Segment& piece) HWY_ATTR { AddHit(state_, piece); });
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
  FramedSpan<FramedKey<T>> framed_;
  Segment nearest_;  // of what stands still; until one is found, none farther than it is of interest
  bool found_ = false;
};

void CollectFast(const Accel& accel, const Ray& ray, RayState& state) { Collector<float>(accel, ray, state).Run(); }
void CollectExact(const Accel& accel, const Ray& ray, RayState& state) { Collector<double>(accel, ray, state).Run(); }
void CollectPacket(const Accel& accel, const RayPacket& packet, std::span<RayState> states) {
  if (accel.still.root != kNoNode || accel.still_instances.root != kNoNode)
    StillPacketCollector(packet, states).Collect(accel);
  if (accel.moving.root != kNoNode || accel.moving_instances.root != kNoNode)
    PacketCollector(packet, states).Collect(accel);
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
