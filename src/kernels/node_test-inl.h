// One ray against the eight children of a node. Compiled once per instruction set; see trace_simd.cpp.

#if defined(KAIROS_NODE_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_NODE_TEST_INL_H
#undef KAIROS_NODE_TEST_INL_H
#else
#define KAIROS_NODE_TEST_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include <hwy/highway.h>

#include "accel/layout.h"
#include "kernels/dispatch.h"
#include "kernels/packet.h"
#include "kernels/ray_state.h"
#include "kernels/time_bins.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Relative error of a slab's entry or exit distance as computed here: a subtraction, a reciprocal and a product, each
/// rounded to within 2^-24, and one more for safety.
inline constexpr float kSlabError = 4 * 0x1p-24f;
/// A root of a linear function in [0, 1], from values that are bounds already: a subtraction and a division.
inline constexpr float kRootError = 4 * 0x1p-24f;
/// Directions' components are kept from zero by this share of the largest one, so that reciprocals are finite and their
/// products with any coordinate below 1e25 too. Over the length of a scene it moves the ray by less than coordinates
/// resolve.
inline constexpr float kLeastDirection = 1e-12f;

/// A ray as the node test wants it.
struct RaySlabs {
  float origin[3], inv[3];
  bool negative[3];

  explicit RaySlabs(const Ray& ray) {
    float largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(ray.direction[k]));
    for (int k = 0; k < 3; ++k) {
      const float d = ray.direction[k];
      origin[k] = ray.origin[k];
      negative[k] = d < 0;
      const float size = std::max(std::abs(d), kLeastDirection * largest);
      inv[k] = 1 / (d < 0 ? -size : size);
    }
  }

  /// The distance at which a plane across axis k is passed.
  template <class D, class V>
  HWY_INLINE V First(D d, size_t k, V plane) const {
    return hn::Mul(hn::Sub(plane, hn::Set(d, origin[k])), hn::Set(d, inv[k]));
  }
  template <class D, class V>
  HWY_INLINE V Last(D d, size_t k, V plane) const {
    return First(d, k, plane);
  }
  /// From where the ray begins.
  template <class D, class V>
  HWY_INLINE V FromStart(D, V dist) const {
    return dist;
  }
};

/// Several rays as the node test wants them: where the first and the last of them pass a plane, from where their depth
/// is 0 on. As functions of time these are a concave and a convex one, so that straight lines between both ends of a
/// key span are bounds of them: what holds for a ray holds for the packet.
struct PacketSlabs {
  float first_origin[3], last_origin[3];  // of the ray that passes a plane first, and last, were all parallel
  float inv_low[3], inv_high[3];
  float last_start;  // in units of the rays' length
  bool negative[3];

  explicit PacketSlabs(const RayPacket& packet) {
    float largest = 0;
    for (int k = 0; k < 3; ++k)
      largest = std::max({largest, std::abs(packet.direction_low[k]), std::abs(packet.direction_high[k])});
    constexpr float kUp = 1 + 0x1p-21f;  // more than what the product and its difference to a distance are rounded by
    last_start = packet.last_start * kUp;
    for (int k = 0; k < 3; ++k) {
      negative[k] = packet.direction_low[k] < 0;
      first_origin[k] = negative[k] ? packet.origin_low[k] : packet.origin_high[k];
      last_origin[k] = negative[k] ? packet.origin_high[k] : packet.origin_low[k];
      const float sign = negative[k] ? -1.0f : 1.0f, least = kLeastDirection * largest;
      const float a = sign / std::max(std::abs(packet.direction_low[k]), least);
      const float b = sign / std::max(std::abs(packet.direction_high[k]), least);
      inv_low[k] = std::min(a, b);
      inv_high[k] = std::max(a, b);
    }
  }

  template <class D, class V>
  HWY_INLINE V First(D d, size_t k, V plane) const {
    const V offset = hn::Sub(plane, hn::Set(d, first_origin[k]));
    return hn::Min(hn::Mul(offset, hn::Set(d, inv_low[k])), hn::Mul(offset, hn::Set(d, inv_high[k])));
  }
  template <class D, class V>
  HWY_INLINE V Last(D d, size_t k, V plane) const {
    const V offset = hn::Sub(plane, hn::Set(d, last_origin[k]));
    return hn::Max(hn::Mul(offset, hn::Set(d, inv_low[k])), hn::Mul(offset, hn::Set(d, inv_high[k])));
  }
  /// From where any of them begins.
  template <class D, class V>
  HWY_INLINE V FromStart(D d, V dist) const {
    return hn::Max(hn::Sub(dist, hn::Set(d, last_start)), hn::Zero(d));
  }
};

template <class D, class M>
HWY_INLINE uint32_t MaskBits(D d, M mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<uint32_t>(bytes[1]) << 8;
}

/// Lanes whose bit is set.
template <class D>
HWY_INLINE hn::Mask<D> LanesOf(D d, uint32_t bits) {
  const uint8_t bytes[8] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

/// The children's time sets within [begin, end] and lower bounds of their distances, both with errors on the safe side:
/// no child that is met is left out, no interval is narrower than the truth. `windows`: when the boxes are those of the
/// node's first and last key; null: when the shutter opens and closes.
template <class Slabs>
HWY_INLINE void TestNode(const Node<kMovingKeys>& node, const ChildWindows* windows, const Slabs& ray, float begin,
                         float end, NodeHits& hits) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V slab_error = hn::Set(d, kSlabError);
  hits.mask = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= node.count) break;
    V in0[3], in1[3], out0[3], out1[3];  // entry and exit of each slab at both ends of the key span
    for (size_t k = 0; k < 3; ++k) {
      const bool neg = ray.negative[k];
      const auto entry = [&](const float* plane) HWY_ATTR {
        const V dist = ray.First(d, k, hn::Load(d, plane + lane));
        return hn::Sub(dist, hn::Mul(hn::Abs(dist), slab_error));
      };
      const auto exit = [&](const float* plane) HWY_ATTR {
        const V dist = ray.Last(d, k, hn::Load(d, plane + lane));
        return hn::Add(dist, hn::Mul(hn::Abs(dist), slab_error));
      };
      in0[k] = entry(neg ? node.upper[0][k] : node.lower[0][k]);
      in1[k] = entry(neg ? node.upper[1][k] : node.lower[1][k]);
      out0[k] = exit(neg ? node.lower[0][k] : node.upper[0][k]);
      out1[k] = exit(neg ? node.lower[1][k] : node.upper[1][k]);
    }
    // Nine linear functions of time must not be negative: six exits minus other slabs' entries, three exits.
    const V a0 = hn::Sub(out0[0], in0[1]), a1 = hn::Sub(out1[0], in1[1]);
    const V b0 = hn::Sub(out0[0], in0[2]), b1 = hn::Sub(out1[0], in1[2]);
    const V c0 = hn::Sub(out0[1], in0[0]), c1 = hn::Sub(out1[1], in1[0]);
    const V d0 = hn::Sub(out0[1], in0[2]), d1 = hn::Sub(out1[1], in1[2]);
    const V e0 = hn::Sub(out0[2], in0[0]), e1 = hn::Sub(out1[2], in1[0]);
    const V f0 = hn::Sub(out0[2], in0[1]), f1 = hn::Sub(out1[2], in1[1]);
    // Signs first: a function that is negative at both ends rejects, and most boxes go that way.
    const V ab = hn::Min(hn::Max(a0, a1), hn::Max(b0, b1));
    const V cd = hn::Min(hn::Max(c0, c1), hn::Max(d0, d1));
    const V ef = hn::Min(hn::Max(e0, e1), hn::Max(f0, f1));
    const V ahead = hn::Min(hn::Min(hn::Max(out0[0], out1[0]), hn::Max(out0[1], out1[1])), hn::Max(out0[2], out1[2]));
    const V least = hn::Min(hn::Min(ab, cd), hn::Min(ef, ahead));
    auto met = hn::And(hn::Ge(least, zero), hn::FirstN(d, node.count - lane));
    if (hn::AllFalse(d, met)) continue;

    V from = zero, to = one;
    const auto restrict_to = [&](V at_begin, V at_end) HWY_ATTR {
      const V root = hn::Div(at_begin, hn::Sub(at_begin, at_end));
      from = hn::IfThenElse(hn::Lt(at_begin, zero), hn::Max(from, root), from);
      to = hn::IfThenElse(hn::Lt(at_end, zero), hn::Min(to, root), to);
    };
    restrict_to(a0, a1);
    restrict_to(b0, b1);
    restrict_to(c0, c1);
    restrict_to(d0, d1);
    restrict_to(e0, e1);
    restrict_to(f0, f1);
    const V behind = hn::Min(hn::Min(hn::Min(out0[0], out1[0]), hn::Min(out0[1], out1[1])), hn::Min(out0[2], out1[2]));
    if (!hn::AllFalse(d, hn::And(met, hn::Lt(behind, zero))))
      for (size_t k = 0; k < 3; ++k) restrict_to(out0[k], out1[k]);
    const V slack = hn::Set(d, kRootError);
    from = hn::Sub(from, slack);
    to = hn::Add(to, slack);
    if (windows == nullptr) {
      from = hn::Max(from, hn::Set(d, begin));
      to = hn::Min(to, hn::Set(d, end));
      hn::Store(from, d, hits.begin + lane);
      hn::Store(to, d, hits.end + lane);
    } else {
      // [begin, end] in the time of the child's window, and what is left of it in that of the shutter.
      const V opens = hn::Load(d, windows->begin.lane + lane), closes = hn::Load(d, windows->end.lane + lane);
      const V length = hn::Sub(closes, opens), snap = hn::Set(d, kTimeSnap);
      from = hn::Max(from, hn::Sub(hn::Div(hn::Sub(hn::Set(d, begin), opens), length), slack));
      to = hn::Min(to, hn::Add(hn::Div(hn::Sub(hn::Set(d, end), opens), length), slack));
      const V shutter_from = hn::Sub(hn::Add(opens, hn::Mul(from, length)), snap);
      const V shutter_to = hn::Add(hn::Add(opens, hn::Mul(to, length)), snap);
      hn::Store(hn::Max(hn::Max(shutter_from, opens), hn::Set(d, begin)), d, hits.begin + lane);
      hn::Store(hn::Min(hn::Min(shutter_to, closes), hn::Set(d, end)), d, hits.end + lane);
    }
    met = hn::And(met, hn::Le(from, to));

    V dist = zero;
    for (size_t k = 0; k < 3; ++k) {
      const V speed = hn::Sub(in1[k], in0[k]);
      const V at_from = hn::Add(in0[k], hn::Mul(from, speed)), at_to = hn::Add(in0[k], hn::Mul(to, speed));
      const V entry = hn::Min(at_from, at_to);
      // The line between two bounds is off by the rounding of its larger end.
      const V error = hn::Mul(hn::Max(hn::Abs(in0[k]), hn::Abs(in1[k])), slab_error);
      dist = hn::Max(dist, hn::Sub(entry, error));
    }
    hn::Store(ray.FromStart(d, dist), d, hits.dist + lane);
    hits.mask |= MaskBits(d, met) << lane;
  }
}

/// The same for boxes that stand still.
template <class Slabs>
HWY_INLINE void TestNode(const Node<kStaticKeys>& node, const Slabs& ray, NodeHits& hits) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V slab_error = hn::Set(d, kSlabError);
  hits.mask = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= node.count) break;
    V in = hn::Zero(d), out = hn::Set(d, std::numeric_limits<float>::infinity());
    for (size_t k = 0; k < 3; ++k) {
      const float* near = ray.negative[k] ? node.upper[0][k] : node.lower[0][k];
      const float* far = ray.negative[k] ? node.lower[0][k] : node.upper[0][k];
      const V entry = ray.First(d, k, hn::Load(d, near + lane));
      const V exit = ray.Last(d, k, hn::Load(d, far + lane));
      in = hn::Max(in, hn::Sub(entry, hn::Mul(hn::Abs(entry), slab_error)));
      out = hn::Min(out, hn::Add(exit, hn::Mul(hn::Abs(exit), slab_error)));
    }
    const auto met = hn::And(hn::Le(in, out), hn::FirstN(d, node.count - lane));
    hn::Store(ray.FromStart(d, in), d, hits.dist + lane);
    hits.mask |= MaskBits(d, met) << lane;
  }
}

/// A bit for each triangle of a block of which [begin, end] touches a key span: from `times` to those in the next row.
HWY_INLINE uint32_t LanesInSpan(const MovingBlock& block, const Row* times, float begin, float end) {
  const uint32_t all = (2u << (block.count - 1)) - 1;
  // A jump takes no time, nor do keys that are repeated.
  if (block.same_times) {
    const float from = times[0].lane[0], to = times[1].lane[0];
    return from <= end && to >= begin && from < to ? all : 0;
  }
  const hn::CappedTag<float, kWidth> d;
  uint32_t lanes = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    const auto from = hn::Load(d, times[0].lane + lane), to = hn::Load(d, times[1].lane + lane);
    const auto touched = hn::And(hn::Le(from, hn::Set(d, end)), hn::Ge(to, hn::Set(d, begin)));
    lanes |= MaskBits(d, hn::And(touched, hn::Lt(from, to))) << lane;
  }
  return lanes & all;
}

/// Puts the children that were met on the stack, the nearest on top.
HWY_INLINE StackEntry* PushChildren(const NodeRef (&child)[kWidth], const NodeHits& hits, bool timed, StackEntry* top) {
  StackEntry* const first = top;
  for (uint32_t mask = hits.mask; mask != 0; mask &= mask - 1) {
    const size_t c = static_cast<size_t>(std::countr_zero(mask));
    const StackEntry entry{child[c], hits.dist[c], timed ? hits.begin[c] : 0, timed ? hits.end[c] : 1};
    StackEntry* place = top++;
    for (; place != first && place[-1].dist < entry.dist; --place) *place = place[-1];
    *place = entry;
  }
  return top;
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
