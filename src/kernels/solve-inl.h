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

/// When the edge functions of a lane are not negative.
template <class D>
struct Stretch {
  hn::Vec<D> begin, end;
  hn::Mask<D> met;      ///< begin < end
  hn::Mask<D> several;  ///< it may be more than one stretch, and is not answered
};

template <class D>
HWY_INLINE Stretch<D> SolveSide(D d, const QuadraticLanes<D> (&e)[3], hn::Mask<D> alive) {
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1);
  const auto clamped = [&](V root) HWY_ATTR { return hn::Min(hn::Max(root, zero), one); };
  V begin = zero, end = one;
  V falls[3], rises[3];  // the ends of what a function that dips below zero cuts out
  hn::Mask<D> dips[3];
  auto dipping = hn::MaskFromVec(zero);
  for (size_t i = 0; i < 3; ++i) {
    const V h = hn::Sub(e[i].b1, e[i].b0);
    const V a = hn::Add(hn::Sub(e[i].b0, e[i].b1), hn::Sub(e[i].b2, e[i].b1));
    const V disc = hn::Sub(hn::Mul(h, h), hn::Mul(a, e[i].b0));
    const V q = hn::Neg(hn::Add(h, hn::CopySign(hn::Sqrt(hn::Max(disc, zero)), h)));
    const auto in_at_begin = hn::Ge(e[i].b0, zero), in_at_end = hn::Ge(e[i].b2, zero);
    const auto real = hn::Gt(disc, zero);
    dips[i] = hn::And(hn::And(in_at_begin, in_at_end), hn::And(hn::Lt(e[i].b1, zero), real));
    const auto passes = hn::AndNot(hn::Or(in_at_begin, in_at_end), hn::And(hn::Gt(e[i].b1, zero), real));
    alive = hn::And(alive, hn::Or(hn::Or(in_at_begin, in_at_end), passes));
    // Of the roots q / a and b0 / q, most lanes need one: where it rises, or falls if it is positive at begin.
    const auto by_a = hn::Xor(in_at_begin, hn::Lt(hn::CopySign(one, h), zero));
    const V change = clamped(hn::Div(hn::IfThenElse(by_a, q, e[i].b0), hn::IfThenElse(by_a, a, q)));
    const V lo = hn::IfThenElse(in_at_begin, zero, change);
    V hi = hn::IfThenElse(in_at_end, one, change);
    if (!hn::AllFalse(d, hn::Or(passes, dips[i]))) {
      rises[i] = clamped(hn::Div(hn::IfThenElse(by_a, e[i].b0, q), hn::IfThenElse(by_a, q, a)));
      hi = hn::IfThenElse(passes, rises[i], hi);
    } else {
      rises[i] = zero;
    }
    falls[i] = change;
    dipping = hn::Or(dipping, dips[i]);
    begin = hn::Max(begin, lo);
    end = hn::Min(end, hi);
  }
  auto several = hn::MaskFromVec(zero);
  // Of what is left on both sides of a cut there is only one stretch most of the time.
  if (!hn::AllFalse(d, hn::And(alive, dipping)))
    for (size_t i = 0; i < 3; ++i) {
      const V before = hn::Min(end, falls[i]), after = hn::Max(begin, rises[i]);
      const auto met_before = hn::Lt(begin, before), met_after = hn::Lt(after, end);
      several = hn::Or(several, hn::And(dips[i], hn::And(met_before, met_after)));
      end = hn::IfThenElse(hn::And(dips[i], met_before), before, end);
      begin = hn::IfThenElse(hn::AndNot(met_before, dips[i]), after, begin);
    }
  return {begin, end, hn::And(alive, hn::Lt(begin, end)), hn::And(alive, several)};
}

/// Solves the lanes in `alive` whose edge functions `e` do not rule out a hit, and puts the answers into `hits` from
/// `lane` on. `behind`: lanes in which a vertex is behind the origin at a key. Overwrites `e`.
template <class D, class M, class Hits>
HWY_INLINE void SolveLanes(D d, const DistLanes<D>& dist, QuadraticLanes<D> (&e)[3], M alive, M behind, size_t lane,
                           Hits& hits) {
  using T = hn::TFromD<D>;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), half = hn::Set(d, T(0.5));
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

  // Make the side that may be seen the front one; of both, the front first.
  const auto turn = [&](M lanes) HWY_ATTR {
    const V flip = hn::IfThenElse(lanes, hn::Set(d, T(-0.0)), zero);
    for (QuadraticLanes<D>& edge : e) {
      edge.b0 = hn::Xor(edge.b0, flip);
      edge.b1 = hn::Xor(edge.b1, flip);
      edge.b2 = hn::Xor(edge.b2, flip);
    }
  };
  turn(hn::Not(front));
  const auto both = hn::And(front, back);
  Stretch<D> side = SolveSide(d, e, alive);
  auto rare = side.several;
  if (!hn::AllFalse(d, both)) {
    turn(both);
    const Stretch<D> other = SolveSide(d, e, both);
    rare = hn::Or(rare, hn::Or(other.several, hn::And(side.met, other.met)));
    side.begin = hn::IfThenElse(other.met, other.begin, side.begin);
    side.end = hn::IfThenElse(other.met, other.end, side.end);
    side.met = hn::Or(side.met, other.met);
    front = hn::AndNot(other.met, front);
  }
  rare = hn::Or(rare, hn::And(side.met, behind));
  const V begin = side.begin, end = side.end;
  const uint32_t rare_bits = MaskBits(d, rare);
  hits.rare |= rare_bits << lane;
  const uint32_t hit_bits = MaskBits(d, side.met) & ~rare_bits;
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
