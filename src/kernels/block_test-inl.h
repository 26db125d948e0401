// One ray against the eight triangles of a block. Compiled once per instruction set; see trace_simd.cpp.
//
// The operations and their order are those of moving_triangle.h, lane by lane, so that both give the same bits; lanes
// whose answer may be more than one interval are left to that code.

#if defined(KAIROS_BLOCK_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_BLOCK_TEST_INL_H
#undef KAIROS_BLOCK_TEST_INL_H
#else
#define KAIROS_BLOCK_TEST_INL_H
#endif

#include <hwy/highway.h>

#include "accel/layout.h"
#include "kernels/moving_triangle.h"
#include "kernels/node_test-inl.h"
#include "kernels/ray_frame.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// Loads floats as T: itself, or widened to double.
template <class D>
HWY_INLINE hn::Vec<D> LoadAs(D d, const float* from) {
  using T = hn::TFromD<D>;
  if constexpr (sizeof(T) == 4) {
    return hn::Load(d, from);
  } else {
    const hn::Rebind<float, D> df;
    return hn::PromoteTo(d, hn::LoadU(df, from));
  }
}

/// Vertices of one key in the frame of the ray.
template <class D>
struct FramedLanes {
  using V = hn::Vec<D>;
  V u[3], v[3], dist[3];

  HWY_INLINE FramedLanes(D d, const RayFrame<hn::TFromD<D>>& frame, const float (&position)[3][3][kWidth],
                         size_t lane) {
    using T = hn::TFromD<D>;
    const V ou = hn::Set(d, T(frame.origin[frame.ku])), ov = hn::Set(d, T(frame.origin[frame.kv]));
    const V ow = hn::Set(d, T(frame.origin[frame.kw]));
    const V su = hn::Set(d, frame.shear_u), sv = hn::Set(d, frame.shear_v), inv = hn::Set(d, frame.inv_w);
    for (size_t i = 0; i < 3; ++i) {
      const V w = hn::Sub(LoadAs(d, position[i][frame.kw] + lane), ow);
      u[i] = hn::Sub(hn::Sub(LoadAs(d, position[i][frame.ku] + lane), ou), hn::Mul(su, w));
      v[i] = hn::Sub(hn::Sub(LoadAs(d, position[i][frame.kv] + lane), ov), hn::Mul(sv, w));
      dist[i] = hn::Mul(inv, w);
    }
  }
};

template <class D>
HWY_INLINE hn::Vec<D> Side(D, const FramedLanes<D>& a, size_t i, const FramedLanes<D>& b, size_t j) {
  return hn::Sub(hn::Mul(a.v[i], b.u[j]), hn::Mul(a.u[i], b.v[j]));
}

template <class D>
struct QuadraticLanes {
  hn::Vec<D> b0, b1, b2;

  HWY_INLINE hn::Vec<D> At(D d, hn::Vec<D> time) const {
    const auto rest = hn::Sub(hn::Set(d, 1), time);
    const auto middle = hn::Mul(hn::Set(d, 2), hn::Mul(time, rest));
    return hn::Add(hn::Add(hn::Mul(hn::Mul(rest, rest), b0), hn::Mul(middle, b1)), hn::Mul(hn::Mul(time, time), b2));
  }
};

/// distance_at, lane by lane; also the sum of the edge functions.
template <class D>
HWY_INLINE hn::Vec<D> DistanceAt(D d, const FramedLanes<D>& key0, const FramedLanes<D>& key1,
                                 const QuadraticLanes<D> (&e)[3], hn::Vec<D> time, hn::Vec<D>& weight) {
  using V = hn::Vec<D>;
  V sum{}, low{}, high{};
  for (size_t i = 0; i < 3; ++i) {
    const V dist = hn::Add(key0.dist[i], hn::Mul(time, hn::Sub(key1.dist[i], key0.dist[i])));
    const V w = e[i].At(d, time);
    sum = i == 0 ? hn::Mul(w, dist) : hn::Add(sum, hn::Mul(w, dist));
    weight = i == 0 ? w : hn::Add(weight, w);
    low = i == 0 ? dist : hn::Min(low, dist);
    high = i == 0 ? dist : hn::Max(high, dist);
  }
  return hn::Max(hn::Min(hn::Div(sum, weight), high), low);
}

/// `nearest_hidden`: triangles with no vertex nearer than this are of no interest.
template <class T>
HWY_INLINE void TestBlock(const TriangleBlock<kMovingKeys>& block, const RayFrame<T>& frame, float nearest_hidden,
                          BlockHits<T>& hits) {
  using D = hn::CappedTag<T, kWidth>;
  const D d;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, T(0.5));
  hits.hit = hits.front = hits.bent = hits.rare = hits.solved = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= block.count) break;
    const FramedLanes<D> key0(d, frame, block.position[0], lane), key1(d, frame, block.position[1], lane);

    V nearest = hn::Min(key0.dist[0], key1.dist[0]), farthest = hn::Max(key0.dist[0], key1.dist[0]);
    for (size_t i = 1; i < 3; ++i) {
      nearest = hn::Min(nearest, hn::Min(key0.dist[i], key1.dist[i]));
      farthest = hn::Max(farthest, hn::Max(key0.dist[i], key1.dist[i]));
    }
    auto alive = hn::And(hn::FirstN(d, block.count - lane), hn::Gt(farthest, zero));
    alive = hn::And(alive, hn::Le(nearest, hn::Set(d, T(nearest_hidden))));

    QuadraticLanes<D> e[3];
    auto front = alive, back = alive;
    V d0 = zero, d1 = zero, d2 = zero;  // the triangle's projected area over time
    for (size_t i = 0; i < 3; ++i) {
      const size_t from = (i + 1) % 3, to = (i + 2) % 3;
      e[i].b0 = Side(d, key0, from, key0, to);
      e[i].b1 = hn::Mul(half, hn::Add(Side(d, key0, from, key1, to), Side(d, key1, from, key0, to)));
      e[i].b2 = Side(d, key1, from, key1, to);
      // A Bernstein form stays between its least and its largest coefficient.
      front = hn::And(front, hn::Ge(hn::Max(hn::Max(e[i].b0, e[i].b1), e[i].b2), zero));
      back = hn::And(back, hn::Le(hn::Min(hn::Min(e[i].b0, e[i].b1), e[i].b2), zero));
      d0 = i == 0 ? e[i].b0 : hn::Add(d0, e[i].b0);
      d1 = i == 0 ? e[i].b1 : hn::Add(d1, e[i].b1);
      d2 = i == 0 ? e[i].b2 : hn::Add(d2, e[i].b2);
    }
    front = hn::And(front, hn::Gt(hn::Max(hn::Max(d0, d1), d2), zero));
    back = hn::And(back, hn::Lt(hn::Min(hn::Min(d0, d1), d2), zero));
    alive = hn::Or(front, back);
    if (hn::AllFalse(d, alive)) continue;
    hits.solved |= MaskBits(d, alive) << lane;

    // Make the one side that may be seen the front one.
    const V flip = hn::IfThenElse(front, zero, hn::Set(d, T(-0.0)));
    auto rare = hn::Or(hn::And(front, back), hn::Le(nearest, zero));
    V begin = zero, end = one;
    for (size_t i = 0; i < 3; ++i) {
      e[i].b0 = hn::Xor(e[i].b0, flip);
      e[i].b1 = hn::Xor(e[i].b1, flip);
      e[i].b2 = hn::Xor(e[i].b2, flip);
      const V h = hn::Sub(e[i].b1, e[i].b0);
      const V a = hn::Add(hn::Sub(e[i].b0, e[i].b1), hn::Sub(e[i].b2, e[i].b1));
      const V disc = hn::Sub(hn::Mul(h, h), hn::Mul(a, e[i].b0));
      const V q = hn::Neg(hn::Add(h, hn::CopySign(hn::Sqrt(hn::Max(disc, zero)), h)));
      const V first = hn::Div(q, a), second = hn::Div(e[i].b0, q);
      const auto falls_at_begin = hn::Lt(hn::CopySign(one, h), zero);
      const V rise = hn::IfThenElse(falls_at_begin, first, second),
              fall = hn::IfThenElse(falls_at_begin, second, first);
      const auto in_at_begin = hn::Ge(e[i].b0, zero), in_at_end = hn::Ge(e[i].b2, zero);
      const auto real = hn::Gt(disc, zero);
      rare = hn::Or(rare, hn::And(hn::And(in_at_begin, in_at_end), hn::And(hn::Lt(e[i].b1, zero), real)));
      const auto in_between = hn::And(hn::Gt(e[i].b1, zero), real);
      alive = hn::And(alive, hn::Or(hn::Or(in_at_begin, in_at_end), in_between));
      const V lo = hn::IfThenElse(in_at_begin, zero, hn::Min(hn::Max(rise, zero), one));
      const V hi = hn::IfThenElse(in_at_end, one, hn::Min(hn::Max(fall, zero), one));
      begin = hn::Max(begin, lo);
      end = hn::Min(end, hi);
    }
    const uint32_t rare_bits = MaskBits(d, hn::And(rare, hn::Or(front, back)));
    hits.rare |= rare_bits << lane;
    const auto hit = hn::And(alive, hn::Lt(begin, end));
    const uint32_t hit_bits = MaskBits(d, hit) & ~rare_bits;
    if (hit_bits == 0) continue;
    hits.hit |= hit_bits << lane;
    hits.front |= (MaskBits(d, front) & hit_bits) << lane;

    V area_begin{}, area_end{}, area_middle{};
    V dist_begin = DistanceAt(d, key0, key1, e, begin, area_begin);
    V dist_end = DistanceAt(d, key0, key1, e, end, area_end);
    const V middle = hn::Mul(half, hn::Add(begin, end));
    const V dist_middle = DistanceAt(d, key0, key1, e, middle, area_middle);
    const V largest = hn::Max(hn::Max(hn::Abs(d0), hn::Abs(d1)), hn::Abs(d2));
    const V least_area = hn::Mul(hn::Set(d, kEdgeOnShare<T>), largest);
    const auto edge_on = hn::Or(hn::Lt(hn::Abs(area_begin), least_area), hn::Lt(hn::Abs(area_end), least_area));
    if ((MaskBits(d, edge_on) & hit_bits) != 0) {
      const V nudge = hn::Mul(hn::Set(d, kEdgeOnNudge<T>), hn::Sub(end, begin));
      const V inner_begin = hn::IfThenElse(hn::Lt(hn::Abs(area_begin), least_area), hn::Add(begin, nudge), begin);
      const V inner_end = hn::IfThenElse(hn::Lt(hn::Abs(area_end), least_area), hn::Sub(end, nudge), end);
      dist_begin = DistanceAt(d, key0, key1, e, inner_begin, area_begin);
      dist_end = DistanceAt(d, key0, key1, e, inner_end, area_end);
    }
    const V straight = hn::Mul(half, hn::Add(dist_begin, dist_end));
    const auto bent =
        hn::Gt(hn::Abs(hn::Sub(dist_middle, straight)), hn::Mul(hn::Set(d, T(kLinearDistance<T>)), dist_middle));
    hits.bent |= (MaskBits(d, bent) & hit_bits) << lane;
    hn::Store(begin, d, hits.begin + lane);
    hn::Store(end, d, hits.end + lane);
    hn::Store(dist_begin, d, hits.dist_begin + lane);
    hn::Store(dist_end, d, hits.dist_end + lane);
  }
}

/// Triangles that stand still: hits.dist_begin is the distance, the time all of it. Nothing is rare or bent.
template <class T>
HWY_INLINE void TestBlock(const TriangleBlock<kStaticKeys>& block, const RayFrame<T>& frame, float nearest_hidden,
                          BlockHits<T>& hits) {
  using D = hn::CappedTag<T, kWidth>;
  const D d;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d);
  hits.hit = hits.front = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= block.count) break;
    const FramedLanes<D> key(d, frame, block.position[0], lane);
    auto front = hn::FirstN(d, block.count - lane), back = front;
    V sum{}, weight{}, low{}, high{};
    for (size_t i = 0; i < 3; ++i) {
      const V w = Side(d, key, (i + 1) % 3, key, (i + 2) % 3);
      front = hn::And(front, hn::Ge(w, zero));
      back = hn::And(back, hn::Le(w, zero));
      sum = i == 0 ? hn::Mul(w, key.dist[i]) : hn::Add(sum, hn::Mul(w, key.dist[i]));
      weight = i == 0 ? w : hn::Add(weight, w);
      low = i == 0 ? key.dist[i] : hn::Min(low, key.dist[i]);
      high = i == 0 ? key.dist[i] : hn::Max(high, key.dist[i]);
    }
    const auto seen = hn::AndNot(hn::Eq(weight, zero), hn::Or(front, back));
    if (hn::AllFalse(d, seen)) continue;
    const V dist = hn::Max(hn::Min(hn::Div(sum, weight), high), low);
    const auto hit = hn::And(seen, hn::And(hn::Gt(dist, zero), hn::Le(dist, hn::Set(d, T(nearest_hidden)))));
    const uint32_t hit_bits = MaskBits(d, hit);
    hits.hit |= hit_bits << lane;
    hits.front |= (MaskBits(d, front) & hit_bits) << lane;
    hn::Store(dist, d, hits.dist_begin + lane);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
