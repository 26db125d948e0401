// A packet of rays and geometry that stands still: the nearest hit of each ray. Compiled once per instruction set; see
// trace_simd.cpp.
//
// As for what moves (packet_test-inl.h), nodes are tested against all rays at once, and an edge function costs two
// products per ray with what the rays share of a triangle. docs/method.md, "Packets".

#if defined(KAIROS_STILL_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_STILL_PACKET_INL_H
#undef KAIROS_STILL_PACKET_INL_H
#else
#define KAIROS_STILL_PACKET_INL_H
#endif

#include <algorithm>
#include <bit>
#include <limits>
#include <span>
#include <utility>

#include <hwy/highway.h>

#include "kernels/packet_test-inl.h"
#include "kernels/placed-inl.h"
#include "kernels/time_bins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// What all rays of a packet have in common of a block's triangles: as PacketTriangles, at one key.
struct alignas(64) StillTriangles {
  PacketTriangles::Term term[3];  ///< [edge]
  float depth[3][kWidth];         ///< [vertex][triangle]
  float nearest[kWidth];          ///< depth of the nearest vertex
  uint32_t candidates = 0;        ///< triangles that any ray may meet
};

/// `nearest_hidden`: triangles with no vertex nearer than this (in units of the rays' length) are of no interest.
HWY_INLINE void PrepareTriangles(const TriangleBlock<kStaticKeys>& block, const RayPacket& packet, float nearest_hidden,
                                 StillTriangles& out) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V zero = hn::Zero(d), error = hn::Set(d, kTermError);
  const V ou = hn::Set(d, packet.origin[packet.ku]), ov = hn::Set(d, packet.origin[packet.kv]);
  const V ow = hn::Set(d, packet.origin[packet.kw]);
  const V su = hn::Set(d, packet.shear_u), sv = hn::Set(d, packet.shear_v), ahead = hn::Set(d, packet.ahead);
  const V wide_u = hn::Set(d, packet.widest_u), wide_v = hn::Set(d, packet.widest_v);
  const V most_depth = hn::Set(d, (nearest_hidden + packet.last_start) / packet.least_dist_per_depth);
  out.candidates = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= block.count) break;
    V u[3], v[3], depth[3], reach[3];
    for (size_t i = 0; i < 3; ++i) {
      const auto& position = block.position[0][i];
      const V w = hn::Sub(hn::Load(d, position[packet.kw] + lane), ow);
      u[i] = hn::Sub(hn::Sub(hn::Load(d, position[packet.ku] + lane), ou), hn::Mul(su, w));
      v[i] = hn::Sub(hn::Sub(hn::Load(d, position[packet.kv] + lane), ov), hn::Mul(sv, w));
      depth[i] = hn::Mul(w, ahead);
      reach[i] = packet.parallel ? hn::Set(d, 1.0f) : depth[i];
      hn::Store(depth[i], d, out.depth[i] + lane);
    }
    const V nearest = hn::Min(hn::Min(depth[0], depth[1]), depth[2]);
    const V farthest = hn::Max(hn::Max(depth[0], depth[1]), depth[2]);
    hn::Store(nearest, d, out.nearest + lane);
    auto front =
        hn::And(hn::FirstN(d, block.count - lane), hn::And(hn::Gt(farthest, zero), hn::Le(nearest, most_depth)));
    auto back = front;
    for (size_t edge = 0; edge < 3; ++edge) {
      const size_t i = (edge + 1) % 3, j = (edge + 2) % 3;
      const V at = hn::Sub(hn::Mul(v[i], u[j]), hn::Mul(u[i], v[j]));
      const V along_u = hn::Sub(hn::Mul(v[i], reach[j]), hn::Mul(reach[i], v[j]));
      const V along_v = hn::Sub(hn::Mul(reach[i], u[j]), hn::Mul(u[i], reach[j]));
      hn::Store(at, d, out.term[edge].at + lane);
      hn::Store(along_u, d, out.term[edge].along_u + lane);
      hn::Store(along_v, d, out.term[edge].along_v + lane);
      // Bounds over all rays.
      const V spread = hn::Add(hn::Mul(wide_u, hn::Abs(along_u)), hn::Mul(wide_v, hn::Abs(along_v)));
      const V slack = hn::Mul(error, hn::Add(hn::Abs(at), spread));
      front = hn::And(front, hn::Ge(hn::Add(hn::Add(at, spread), slack), zero));
      back = hn::And(back, hn::Le(hn::Sub(hn::Sub(at, spread), slack), zero));
    }
    out.candidates |= MaskBits(d, hn::Or(front, back)) << lane;
  }
}

/// Pairs of a ray and a triangle that meet; lanes as in PacketHits.
struct alignas(64) StillHits {
  float dist[kPacketLanes];
  uint32_t hit, front;
};

/// visible_until: per lane; hits farther than that are of no interest.
template <size_t kRays>
HWY_INLINE void TestPacket(const StillTriangles& triangles, size_t triangle, const RayPacket& packet,
                           const float* visible_until, StillHits& hits) {
  using D = hn::CappedTag<float, kPacketLanes>;
  const D d;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d);
  const auto value = [&](const float* of_triangles) HWY_ATTR {
    if constexpr (kRays == kPacketLanes)
      return hn::Set(d, of_triangles[triangle]);
    else
      return hn::LoadDup128(d, of_triangles + triangle);
  };
  // Lanes of triangles that are no candidates, and those without a ray, are not looked at.
  const size_t lanes_used = packet.rays.size() * (kPacketLanes / kRays);
  uint32_t wanted = (1u << lanes_used) - 1;
  if constexpr (kRays != kPacketLanes) wanted &= (triangles.candidates >> triangle & 0xf) * 0x1111u;
  hits.hit = hits.front = 0;
  for (size_t lane = 0; lane < lanes_used; lane += hn::Lanes(d)) {
    const V lean_u = hn::Load(d, packet.lean_u + lane), lean_v = hn::Load(d, packet.lean_v + lane);
    const V farthest = hn::Load(d, visible_until + lane);
    V sum{}, weight{}, low{}, high{};
    V least{}, most{};
    for (size_t i = 0; i < 3; ++i) {
      const V e = hn::Sub(hn::Sub(value(triangles.term[i].at), hn::Mul(lean_u, value(triangles.term[i].along_u))),
                          hn::Mul(lean_v, value(triangles.term[i].along_v)));
      const V depth = value(triangles.depth[i]);
      least = i == 0 ? e : hn::Min(least, e);
      most = i == 0 ? e : hn::Max(most, e);
      sum = i == 0 ? hn::Mul(e, depth) : hn::Add(sum, hn::Mul(e, depth));
      weight = i == 0 ? e : hn::Add(weight, e);
      low = i == 0 ? depth : hn::Min(low, depth);
      high = i == 0 ? depth : hn::Max(high, depth);
    }
    const auto front = hn::Ge(least, zero);
    const auto seen = hn::AndNot(hn::Eq(weight, zero), hn::Or(front, hn::Le(most, zero)));
    if (hn::AllFalse(d, seen)) continue;
    const V depth = hn::Max(hn::Min(hn::Div(sum, weight), high), low);
    const V from_plane = hn::Mul(depth, hn::Load(d, packet.dist_per_depth + lane));
    const V dist = hn::Sub(from_plane, hn::Load(d, packet.start + lane));
    const auto hit = hn::And(seen, hn::And(hn::Gt(dist, zero), hn::Le(dist, farthest)));
    const uint32_t hit_bits = MaskBits(d, hit) << lane & wanted;
    hits.hit |= hit_bits;
    hits.front |= MaskBits(d, front) << lane & hit_bits;
    hn::Store(dist, d, hits.dist + lane);
  }
}

/// Puts into each ray's list the nearest hit, which hides what is behind it at all times; or all of them, where nothing
/// is to be culled.
class StillPacketCollector {
 public:
  /// states: one per ray of the packet, begun. What they already know to be hidden is not visited.
  StillPacketCollector(const RayPacket& packet, std::span<RayState> states)
      : packet_(packet), slabs_(packet), states_(states), culls_(states[0].culls()) {
    for (size_t ray = 0; ray < states.size(); ++ray) {
      nearest_[ray].dist_begin = states[ray].clips() ? VisibleUntil(states[ray].bins, TimeBins::touched(0, 1))
                                                     : std::numeric_limits<float>::infinity();
      SetVisibleUntil(ray, nearest_[ray].dist_begin);
    }
    UpdateFarthest();
  }

  void Collect(const Accel& accel) {
    StackEntry* const bottom = states_[0].stack.data();
    if (accel.still.root != kNoNode) {
      StillSource source(accel.still);
      Walk(source, {accel.still.root, 0, 0, 1}, bottom);
    }
    if (accel.still_instances.root != kNoNode)
      WalkInstances(
          accel.still_instances, slabs_, bottom, states_[0].counters,
          [&](const StackEntry& entry) HWY_ATTR { return entry.dist > farthest_; },
          [&](const Instance& instance, const StackEntry& entry, StackEntry* top) HWY_ATTR {
            PlacedStillSource source(accel, instance);
            Walk(source, {source.Root(), entry.dist, 0, 1}, top);
            return true;
          });
    for (size_t ray = 0; ray < states_.size(); ++ray)
      if (nearest_[ray].begin < nearest_[ray].end) AddHit(states_[ray], nearest_[ray]);
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
      const StackEntry entry = *--top;
      if (entry.dist > farthest_) continue;
      if ((entry.node & kLeafBit) == 0) {
        const auto& node = source.NodeAt(entry.node);
        ++counters.nodes;
        TestNode(node, slabs_, node_hits);
        top = PushChildren(node.child, node_hits, false, top);
        continue;
      }
      const auto& block = source.BlockAt(entry.node);
      counters.triangles += block.count;
      PrepareTriangles(block, packet_, farthest_, triangles_);
      if (packet_.rays_per_register == kPacketLanes)
        TestCandidates<kPacketLanes>(block);
      else
        TestCandidates<kPacketLanes / 4>(block);
    }
  }

  template <size_t kRays>
  HWY_INLINE void TestCandidates(const TriangleBlock<kStaticKeys>& block) {
    constexpr size_t kStep = kPacketLanes / kRays;  // triangles beside each other
    constexpr uint32_t kGroup = (1u << kStep) - 1;
    bool nearer = false;
    for (uint32_t left = triangles_.candidates; left != 0;) {
      const size_t first = static_cast<size_t>(std::countr_zero(left)) / kStep * kStep;
      left &= ~(kGroup << first);
      TestPacket<kRays>(triangles_, first, packet_, visible_until_, hits_);
      for (uint32_t mask = hits_.hit; mask != 0; mask &= mask - 1) {
        const size_t lane = static_cast<size_t>(std::countr_zero(mask));
        nearer |= Meet(block, lane, first + lane % kStep, lane / kStep);
      }
    }
    if (nearer) UpdateFarthest();
  }

  /// A hit of one ray. True when it is the nearest one so far.
  HWY_INLINE bool Meet(const TriangleBlock<kStaticKeys>& block, size_t lane, size_t triangle, size_t ray) {
    const float dist = hits_.dist[lane];
    const Segment hit{0, 1, dist, dist, block.mesh[triangle], block.triangle[triangle], (hits_.front >> lane & 1) != 0};
    RayState& state = states_[ray];
    Segment& nearest = nearest_[ray];
    const bool is_nearest =
        dist < nearest.dist_begin ||
        (dist == nearest.dist_begin && std::pair(hit.mesh, hit.triangle) < std::pair(nearest.mesh, nearest.triangle));
    if ((culls_ && !is_nearest) || !state.is_there(hit)) return false;
    if (!culls_) {
      state.add(hit);
      return false;
    }
    nearest = hit;
    SetVisibleUntil(ray, dist);
    return true;
  }

  HWY_INLINE void SetVisibleUntil(size_t ray, float dist) {
    const size_t step = kPacketLanes / packet_.rays_per_register;
    for (size_t lane = ray * step; lane < (ray + 1) * step; ++lane) visible_until_[lane] = dist;
  }
  HWY_INLINE void UpdateFarthest() {
    const hn::CappedTag<float, kPacketLanes> d;
    auto farthest = hn::Load(d, visible_until_);
    for (size_t lane = hn::Lanes(d); lane < kPacketLanes; lane += hn::Lanes(d))
      farthest = hn::Max(farthest, hn::Load(d, visible_until_ + lane));
    farthest_ = hn::GetLane(hn::MaxOfLanes(d, farthest));
  }

  const RayPacket& packet_;
  const PacketSlabs slabs_;
  const std::span<RayState> states_;
  const bool culls_;
  alignas(64) float visible_until_[kPacketLanes]{};  // [lane]; 0 for those without a ray
  float farthest_ = 0;                               // of all rays
  StillTriangles triangles_;
  StillHits hits_{};
  Segment nearest_[kPacketLanes];  // [ray]; without duration: none yet, and none farther is of interest
};

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
