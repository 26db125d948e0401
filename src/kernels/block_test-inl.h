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
#include "kernels/around-inl.h"
#include "kernels/moving_triangle.h"
#include "kernels/node_test-inl.h"
#include "kernels/ray_frame.h"
#include "kernels/solve-inl.h"

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

/// A block's vertices at a key in the frame of a ray, kept for the key spans on both sides of it, and the rectangles
/// around them.
template <class T>
struct alignas(64) FramedKey {
  T u[3][kWidth], v[3][kWidth], dist[3][kWidth];  ///< [vertex][triangle]
  Around<T> around;
};

/// Vertices of one key in the frame of the ray.
template <class D>
struct FramedLanes {
  using V = hn::Vec<D>;
  V u[3], v[3], dist[3];

  HWY_INLINE FramedLanes(D d, const RayFrame<hn::TFromD<D>>& frame, const BlockKey& key, size_t lane)
      : FramedLanes(d, frame, key.position, lane) {}
  HWY_INLINE FramedLanes(D d, const RayFrame<hn::TFromD<D>>&, const FramedKey<hn::TFromD<D>>& key, size_t lane) {
    for (size_t i = 0; i < 3; ++i) {
      u[i] = hn::Load(d, key.u[i] + lane);
      v[i] = hn::Load(d, key.v[i] + lane);
      dist[i] = hn::Load(d, key.dist[i] + lane);
    }
  }

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

template <class T>
HWY_INLINE void FrameKey(const BlockKey& from, const RayFrame<T>& frame, FramedKey<T>& to) {
  using D = hn::CappedTag<T, kWidth>;
  const D d;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    const FramedLanes<D> key(d, frame, from.position, lane);
    for (size_t i = 0; i < 3; ++i) {
      hn::Store(key.u[i], d, to.u[i] + lane);
      hn::Store(key.v[i], d, to.v[i] + lane);
      hn::Store(key.dist[i], d, to.dist[i] + lane);
    }
    to.around.Set(d, lane, key.u, key.u, key.v, key.v);
  }
}

/// The triangles `lanes` of a block between two keys, each a BlockKey or a FramedKey. `nearest_hidden`: triangles with
/// no vertex nearer than this are of no interest.
template <class T, class Key>
HWY_INLINE void TestBlock(const Key& begin, const Key& end, uint32_t lanes, const RayFrame<T>& frame,
                          float nearest_hidden, BlockHits<T>& hits) {
  using D = hn::CappedTag<T, kWidth>;
  const D d;
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), half = hn::Set(d, T(0.5));
  hits.hit = hits.front = hits.bent = hits.rare = hits.solved = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lanes >> lane == 0) break;
    const FramedLanes<D> key0(d, frame, begin, lane), key1(d, frame, end, lane);

    V nearest = hn::Min(key0.dist[0], key1.dist[0]), farthest = hn::Max(key0.dist[0], key1.dist[0]);
    for (size_t i = 1; i < 3; ++i) {
      nearest = hn::Min(nearest, hn::Min(key0.dist[i], key1.dist[i]));
      farthest = hn::Max(farthest, hn::Max(key0.dist[i], key1.dist[i]));
    }
    auto alive = hn::And(LanesOf(d, lanes >> lane), hn::Gt(farthest, zero));
    alive = hn::And(alive, hn::Le(nearest, hn::Set(d, T(nearest_hidden))));

    QuadraticLanes<D> e[3];
    for (size_t i = 0; i < 3; ++i) {
      const size_t from = (i + 1) % 3, to = (i + 2) % 3;
      e[i].b0 = Side(d, key0, from, key0, to);
      e[i].b1 = hn::Mul(half, hn::Add(Side(d, key0, from, key1, to), Side(d, key1, from, key0, to)));
      e[i].b2 = Side(d, key1, from, key1, to);
    }
    SolveLanes(d, DistLanes<D>{key0.dist, key1.dist}, e, alive, hn::Le(nearest, zero), lane, hits);
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
