// Which triangles of a block a ray cannot meet in a key span, found before their edge functions are. Compiled once per
// instruction set; see trace_simd.cpp.
//
// A leaf that a ray is in for a while has several key spans, and in most of them most triangles are somewhere else.
// What the rectangles around a triangle at both ends of a span tell costs a fraction of a test, and a key's serves for
// the spans on both sides of it.

#if defined(KAIROS_AROUND_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_AROUND_INL_H
#undef KAIROS_AROUND_INL_H
#else
#define KAIROS_AROUND_INL_H
#endif

#include <hwy/highway.h>

#include "accel/layout.h"
#include "kernels/node_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// A triangle that keeps this share of its size away from a ray is on one side of it, whatever rounding does to its
/// edge functions: these are off by a few units of 2^-24.
inline constexpr float kApartShare = 0x1p-18f;

/// Rectangles in the frame of a ray, or of a packet's middle, around the triangles of a block at a key.
template <class T>
struct alignas(64) Around {
  T low[2][kWidth], high[2][kWidth];  ///< [u or v][triangle]

  /// From the least and the largest u and v of the vertices over all rays.
  template <class D, class V = hn::Vec<D>>
  HWY_INLINE void Set(D d, size_t lane, const V (&least_u)[3], const V (&most_u)[3], const V (&least_v)[3],
                      const V (&most_v)[3]) {
    hn::Store(hn::Min(hn::Min(least_u[0], least_u[1]), least_u[2]), d, low[0] + lane);
    hn::Store(hn::Max(hn::Max(most_u[0], most_u[1]), most_u[2]), d, high[0] + lane);
    hn::Store(hn::Min(hn::Min(least_v[0], least_v[1]), least_v[2]), d, low[1] + lane);
    hn::Store(hn::Max(hn::Max(most_v[0], most_v[1]), most_v[2]), d, high[1] + lane);
  }
};

/// A bit for each triangle that may be met between two keys: its vertices go straight, so it is within both
/// rectangles' union.
template <class T>
HWY_INLINE uint32_t LanesMet(const Around<T>& begin, const Around<T>& end) {
  const hn::CappedTag<T, kWidth> d;
  const auto share = hn::Set(d, T(kApartShare));
  uint32_t apart = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    const auto is_apart = [&](size_t k) HWY_ATTR {
      const auto low = hn::Min(hn::Load(d, begin.low[k] + lane), hn::Load(d, end.low[k] + lane));
      const auto high = hn::Max(hn::Load(d, begin.high[k] + lane), hn::Load(d, end.high[k] + lane));
      return hn::Or(hn::Gt(low, hn::Mul(share, high)), hn::Lt(high, hn::Mul(share, low)));
    };
    apart |= MaskBits(d, hn::Or(is_apart(0), is_apart(1))) << lane;
  }
  return ~apart;
}

/// The keys at both ends of a key span in the frame of rays; spans that follow on each other share one.
template <class Framed>
class FramedSpan {
 public:
  /// Goes to the next span, which follows on the last one or does not. frame(key, framed) fills in a key.
  /// Returns the triangles of it that may be met.
  template <class Frame>
  HWY_INLINE uint32_t Enter(const Span& span, bool follows, const Frame& frame) {
    if (follows)
      first_ = 1 - first_;
    else
      frame(span.key0, key_[first_]);
    frame(span.key1, key_[1 - first_]);
    return LanesMet(key_[0].around, key_[1].around);
  }
  const Framed& begin() const { return key_[first_]; }
  const Framed& end() const { return key_[1 - first_]; }

 private:
  Framed key_[2];
  size_t first_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
