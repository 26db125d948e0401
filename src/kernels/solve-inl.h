// From edge functions to the interval in which a ray meets a triangle, for pairs of a ray and a triangle in vector
// lanes. Compiled once per instruction set; see trace_simd.cpp.
//
// The operations and their order are those of moving_triangle.h, lane by lane, so that both give the same bits; lanes
// whose answer may be more than one interval are left to that code.

#if defined(KAIROS_SOLVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_SOLVE_INL_H
#undef KAIROS_SOLVE_INL_H
#else
#define KAIROS_SOLVE_INL_H
#endif

#include <hwy/highway.h>

#include "kernels/moving_triangle.h"
#include "kernels/node_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// Distances of the three vertices along the ray at both keys.
template <class D>
struct DistLanes {
  const hn::Vec<D> (&key0)[3];
  const hn::Vec<D> (&key1)[3];
};

template <class D>
struct QuadraticLanes {
  hn::Vec<D> b0, b1, b2;

  HWY_INLINE hn::Vec<D> At(D d, hn::Vec<D> time) const {
    const auto rest = hn::Sub(hn::Set(d, 1), time);
    const auto middle = hn::Mul(hn::Set(d, 2), hn::Mul(time, rest));
    return hn::Add(hn::Add(hn::Mul(hn::Mul(rest, rest), b0), hn::Mul(middle, b1)), hn::Mul(hn::Mul(time, time), b2));
  }
};

/// sum(e_i dist_i) at `time`, and sum(e_i).
template <class D>
HWY_INLINE hn::Vec<D> DistanceSum(D d, const DistLanes<D>& dist, const QuadraticLanes<D> (&e)[3], hn::Vec<D> time,
                                  hn::Vec<D>& weight) {
  hn::Vec<D> sum{};
  for (size_t i = 0; i < 3; ++i) {
    const auto here = hn::Add(dist.key0[i], hn::Mul(time, hn::Sub(dist.key1[i], dist.key0[i])));
    const auto w = e[i].At(d, time);
    sum = i == 0 ? hn::Mul(w, here) : hn::Add(sum, hn::Mul(w, here));
    weight = i == 0 ? w : hn::Add(weight, w);
  }
  return sum;
}

/// distance_at, lane by lane; also sum(e_i).
template <class D>
HWY_INLINE hn::Vec<D> DistanceAt(D d, const DistLanes<D>& dist, const QuadraticLanes<D> (&e)[3], hn::Vec<D> time,
                                 hn::Vec<D>& weight) {
  using V = hn::Vec<D>;
  const V sum = DistanceSum(d, dist, e, time, weight);
  V low{}, high{};
  for (size_t i = 0; i < 3; ++i) {
    const V here = hn::Add(dist.key0[i], hn::Mul(time, hn::Sub(dist.key1[i], dist.key0[i])));
    low = i == 0 ? here : hn::Min(low, here);
    high = i == 0 ? here : hn::Max(high, here);
  }
  return hn::Max(hn::Min(hn::Div(sum, weight), high), low);
}

/// Solves the lanes in `alive` whose edge functions `e` do not rule out a hit, and puts the answers into `hits` from
/// `lane` on. `behind`: lanes in which a vertex is behind the origin at a key. Overwrites `e`.
template <class D, class M, class Hits>
HWY_INLINE void SolveLanes(D d, const DistLanes<D>& dist, QuadraticLanes<D> (&e)[3], M alive, M behind, size_t lane,
                           Hits& hits) {
  using T = hn::TFromD<D>;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, T(0.5));
  auto front = alive, back = alive;
  V d0 = zero, d1 = zero, d2 = zero;  // the triangle's projected area over time
  for (size_t i = 0; i < 3; ++i) {
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
  if (hn::AllFalse(d, alive)) return;
  hits.solved |= MaskBits(d, alive) << lane;

  // Make the one side that may be seen the front one.
  const V flip = hn::IfThenElse(front, zero, hn::Set(d, T(-0.0)));
  auto rare = hn::Or(hn::And(front, back), behind);
  V begin = zero, end = one;
  for (size_t i = 0; i < 3; ++i) {
    e[i].b0 = hn::Xor(e[i].b0, flip);
    e[i].b1 = hn::Xor(e[i].b1, flip);
    e[i].b2 = hn::Xor(e[i].b2, flip);
    const V h = hn::Sub(e[i].b1, e[i].b0);
    const V a = hn::Add(hn::Sub(e[i].b0, e[i].b1), hn::Sub(e[i].b2, e[i].b1));
    const V disc = hn::Sub(hn::Mul(h, h), hn::Mul(a, e[i].b0));
    const V q = hn::Neg(hn::Add(h, hn::CopySign(hn::Sqrt(hn::Max(disc, zero)), h)));
    const auto in_at_begin = hn::Ge(e[i].b0, zero), in_at_end = hn::Ge(e[i].b2, zero);
    const auto real = hn::Gt(disc, zero);
    rare = hn::Or(rare, hn::And(hn::And(in_at_begin, in_at_end), hn::And(hn::Lt(e[i].b1, zero), real)));
    const auto passes = hn::AndNot(hn::Or(in_at_begin, in_at_end), hn::And(hn::Gt(e[i].b1, zero), real));
    alive = hn::And(alive, hn::Or(hn::Or(in_at_begin, in_at_end), passes));
    // Of the roots q / a and b0 / q, most lanes need one: where it rises, or falls if it is positive at begin.
    const auto by_a = hn::Xor(in_at_begin, hn::Lt(hn::CopySign(one, h), zero));
    const V root = hn::Div(hn::IfThenElse(by_a, q, e[i].b0), hn::IfThenElse(by_a, a, q));
    const V change = hn::Min(hn::Max(root, zero), one);
    const V lo = hn::IfThenElse(in_at_begin, zero, change);
    V hi = hn::IfThenElse(in_at_end, one, change);
    if (!hn::AllFalse(d, passes)) {
      const V other = hn::Div(hn::IfThenElse(by_a, e[i].b0, q), hn::IfThenElse(by_a, q, a));
      hi = hn::IfThenElse(passes, hn::Min(hn::Max(other, zero), one), hi);
    }
    begin = hn::Max(begin, lo);
    end = hn::Min(end, hi);
  }
  const uint32_t rare_bits = MaskBits(d, hn::And(rare, hn::Or(front, back)));
  hits.rare |= rare_bits << lane;
  const auto hit = hn::And(alive, hn::Lt(begin, end));
  const uint32_t hit_bits = MaskBits(d, hit) & ~rare_bits;
  if (hit_bits == 0) return;
  hits.hit |= hit_bits << lane;
  hits.front |= (MaskBits(d, front) & hit_bits) << lane;

  V area_begin{}, area_end{};
  V dist_begin = DistanceAt(d, dist, e, begin, area_begin);
  V dist_end = DistanceAt(d, dist, e, end, area_end);
  const V largest = hn::Max(hn::Max(hn::Abs(d0), hn::Abs(d1)), hn::Abs(d2));
  const V least_area = hn::Mul(hn::Set(d, kEdgeOnShare<T>), largest);
  const auto edge_on = hn::Or(hn::Lt(hn::Abs(area_begin), least_area), hn::Lt(hn::Abs(area_end), least_area));
  if ((MaskBits(d, edge_on) & hit_bits) != 0) {
    const V nudge = hn::Mul(hn::Set(d, kEdgeOnNudge<T>), hn::Sub(end, begin));
    const V inner_begin = hn::IfThenElse(hn::Lt(hn::Abs(area_begin), least_area), hn::Add(begin, nudge), begin);
    const V inner_end = hn::IfThenElse(hn::Lt(hn::Abs(area_end), least_area), hn::Sub(end, nudge), end);
    dist_begin = DistanceAt(d, dist, e, inner_begin, area_begin);
    dist_end = DistanceAt(d, dist, e, inner_end, area_end);
  }
  const V straight = hn::Mul(half, hn::Add(dist_begin, dist_end));
  // Is the distance in the middle far from there? Without dividing: sum / area against straight.
  V area_middle{};
  const V sum_middle = DistanceSum(d, dist, e, hn::Mul(half, hn::Add(begin, end)), area_middle);
  const V off = hn::Abs(hn::Sub(sum_middle, hn::Mul(straight, area_middle)));
  const auto bent = hn::Gt(off, hn::Mul(hn::Set(d, T(kLinearDistance<T>)), hn::Abs(sum_middle)));
  hits.bent |= (MaskBits(d, bent) & hit_bits) << lane;
  hn::Store(begin, d, hits.begin + lane);
  hn::Store(end, d, hits.end + lane);
  hn::Store(dist_begin, d, hits.dist_begin + lane);
  hn::Store(dist_end, d, hits.dist_end + lane);
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
