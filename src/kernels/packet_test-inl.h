// A packet of rays against the eight triangles of a block. Compiled once per instruction set; see trace_simd.cpp.
//
// An edge function is a triple product of the ray's direction and two vertices. The vertices' cross products, which are
// the same for all rays from one origin, are computed for the block's triangles side by side; with them an edge
// function of one ray costs two products. For parallel rays 1 takes the place of the vertices' depths. Exchanging an
// edge's vertices negates every term bit for bit: shared edges stay watertight. docs/method.md, "Packets".

#if defined(KAIROS_PACKET_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_PACKET_TEST_INL_H
#undef KAIROS_PACKET_TEST_INL_H
#else
#define KAIROS_PACKET_TEST_INL_H
#endif

#include <hwy/highway.h>

#include "accel/layout.h"
#include "kernels/around-inl.h"
#include "kernels/packet.h"
#include "kernels/solve-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// A bound of the rounding errors of an edge function's terms, as a share of their magnitudes.
inline constexpr float kTermError = 16 * 0x1p-24f;

/// What all rays of a packet have in common of a block's triangles. An edge function's Bernstein coefficient is
/// at - lean_u along_u - lean_v along_v.
struct alignas(64) PacketTriangles {
  struct Term {
    float at[kWidth], along_u[kWidth], along_v[kWidth];  ///< [triangle]
  };
  Term term[3][3];            ///< [edge][coefficient]
  float depth[2][3][kWidth];  ///< [key][vertex][triangle]
  float nearest[kWidth];      ///< depth of the nearest vertex
  uint32_t candidates = 0;    ///< triangles that any ray may meet
};

/// As FramedKey, in the frame of a packet's middle.
struct alignas(64) PacketKey {
  float u[3][kWidth], v[3][kWidth], depth[3][kWidth];  ///< [vertex][triangle]
  Around<float> around;
};

/// Vertices of one key in the frame of a packet's middle.
template <class D>
struct PacketLanes {
  using V = hn::Vec<D>;
  V u[3], v[3], depth[3];

  HWY_INLINE PacketLanes(D d, const RayPacket& packet, const float (&position)[3][3][kWidth], size_t lane) {
    const V ou = hn::Set(d, packet.origin[packet.ku]), ov = hn::Set(d, packet.origin[packet.kv]);
    const V ow = hn::Set(d, packet.origin[packet.kw]);
    const V su = hn::Set(d, packet.shear_u), sv = hn::Set(d, packet.shear_v), ahead = hn::Set(d, packet.ahead);
    for (size_t i = 0; i < 3; ++i) {
      const V w = hn::Sub(hn::Load(d, position[i][packet.kw] + lane), ow);
      u[i] = hn::Sub(hn::Sub(hn::Load(d, position[i][packet.ku] + lane), ou), hn::Mul(su, w));
      v[i] = hn::Sub(hn::Sub(hn::Load(d, position[i][packet.kv] + lane), ov), hn::Mul(sv, w));
      depth[i] = hn::Mul(w, ahead);
    }
  }
  HWY_INLINE PacketLanes(D d, const RayPacket& packet, const BlockKey& key, size_t lane)
      : PacketLanes(d, packet, key.position, lane) {}
  HWY_INLINE PacketLanes(D d, const RayPacket&, const PacketKey& key, size_t lane) {
    for (size_t i = 0; i < 3; ++i) {
      u[i] = hn::Load(d, key.u[i] + lane);
      v[i] = hn::Load(d, key.v[i] + lane);
      depth[i] = hn::Load(d, key.depth[i] + lane);
    }
  }
};

HWY_INLINE void FrameKey(const BlockKey& from, const RayPacket& packet, PacketKey& to) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V wide_u = hn::Set(d, packet.widest_u), wide_v = hn::Set(d, packet.widest_v);
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    const PacketLanes<decltype(d)> key(d, packet, from, lane);
    V least_u[3], most_u[3], least_v[3], most_v[3];  // over all rays
    for (size_t i = 0; i < 3; ++i) {
      hn::Store(key.u[i], d, to.u[i] + lane);
      hn::Store(key.v[i], d, to.v[i] + lane);
      hn::Store(key.depth[i], d, to.depth[i] + lane);
      const V size = packet.parallel ? hn::Set(d, 1.0f) : hn::Abs(key.depth[i]), lean_u = hn::Mul(wide_u, size),
              lean_v = hn::Mul(wide_v, size);
      least_u[i] = hn::Sub(key.u[i], lean_u);
      most_u[i] = hn::Add(key.u[i], lean_u);
      least_v[i] = hn::Sub(key.v[i], lean_v);
      most_v[i] = hn::Add(key.v[i], lean_v);
    }
    to.around.Set(d, lane, least_u, most_u, least_v, most_v);
  }
}

/// The triangles `lanes` of a block in a key span between two keys, each a BlockKey or a PacketKey. `nearest_hidden`:
/// triangles with no vertex nearer than this (in units of the rays' length) are of no interest, nor are those that no
/// ray meets in [begin, end], which is shutter time.
template <class Key>
HWY_INLINE void PrepareTriangles(const Span& span, const Key& at_begin, const Key& at_end, uint32_t lanes,
                                 const RayPacket& packet, float begin, float end, float nearest_hidden,
                                 PacketTriangles& out) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V wide_u = hn::Set(d, packet.widest_u), wide_v = hn::Set(d, packet.widest_v);
  const V error = hn::Set(d, kTermError);
  const V most_depth = hn::Set(d, (nearest_hidden + packet.last_start) / packet.least_dist_per_depth);
  const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  out.candidates = 0;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lanes >> lane == 0) break;
    // [begin, end] in the time of the key spans, and the weights of the Bernstein coefficients on [0, 1] in those
    // there.
    const V opens = hn::Load(d, span.begin.lane + lane), length = hn::Sub(hn::Load(d, span.end.lane + lane), opens);
    const auto in_span = [&](float time) HWY_ATTR {
      return hn::Max(hn::Min(hn::Div(hn::Sub(hn::Set(d, time), opens), length), one), zero);
    };
    const V first = in_span(begin), last = in_span(end);
    const V rest_first = hn::Sub(one, first), rest_last = hn::Sub(one, last);
    const V part[3][3] = {
        {hn::Mul(rest_first, rest_first), hn::Mul(hn::Mul(two, first), rest_first), hn::Mul(first, first)},
        {hn::Mul(rest_first, rest_last), hn::Add(hn::Mul(first, rest_last), hn::Mul(last, rest_first)),
         hn::Mul(first, last)},
        {hn::Mul(rest_last, rest_last), hn::Mul(hn::Mul(two, last), rest_last), hn::Mul(last, last)}};
    const PacketLanes<decltype(d)> key[2] = {{d, packet, at_begin, lane}, {d, packet, at_end, lane}};
    V nearest = key[0].depth[0], farthest = nearest;
    for (size_t k = 0; k < 2; ++k)
      for (size_t i = 0; i < 3; ++i) {
        hn::Store(key[k].depth[i], d, out.depth[k][i] + lane);
        nearest = hn::Min(nearest, key[k].depth[i]);
        farthest = hn::Max(farthest, key[k].depth[i]);
      }
    hn::Store(nearest, d, out.nearest + lane);
    auto alive = hn::And(LanesOf(d, lanes >> lane), hn::Gt(farthest, zero));
    alive = hn::And(alive, hn::Le(nearest, most_depth));

    auto front = alive, back = alive;
    for (size_t edge = 0; edge < 3; ++edge) {
      const size_t i = (edge + 1) % 3, j = (edge + 2) % 3;
      V at[3], along_u[3], along_v[3];
      for (size_t c = 0; c < 3; ++c) {
        const auto coefficient = [&](const auto& at_keys) HWY_ATTR {
          return c == 1 ? hn::Mul(half, hn::Add(at_keys(0, 1), at_keys(1, 0))) : at_keys(c / 2, c / 2);
        };
        const auto cross = [&](auto a, auto b) HWY_ATTR {
          return coefficient([&](size_t key_i, size_t key_j) HWY_ATTR {
            return hn::Sub(hn::Mul((key[key_i].*a)[i], (key[key_j].*b)[j]),
                           hn::Mul((key[key_i].*b)[i], (key[key_j].*a)[j]));
          });
        };
        using L = PacketLanes<decltype(d)>;
        at[c] = cross(&L::v, &L::u);
        if (packet.parallel) {  // 1 in place of the depths
          along_u[c] = coefficient([&](size_t key_i, size_t key_j)
                                       HWY_ATTR { return hn::Sub(key[key_i].v[i], key[key_j].v[j]); });
          along_v[c] = coefficient([&](size_t key_i, size_t key_j)
                                       HWY_ATTR { return hn::Sub(key[key_j].u[j], key[key_i].u[i]); });
        } else {
          along_u[c] = cross(&L::v, &L::depth);
          along_v[c] = cross(&L::depth, &L::u);
        }
        hn::Store(at[c], d, out.term[edge][c].at + lane);
        hn::Store(along_u[c], d, out.term[edge][c].along_u + lane);
        hn::Store(along_v[c], d, out.term[edge][c].along_v + lane);
      }
      // Bounds over all rays, within the leaf's time. A Bernstein form stays between its coefficients.
      const V size = hn::Max(hn::Max(hn::Abs(at[0]), hn::Abs(at[1])), hn::Abs(at[2]));
      V highest{}, lowest{};
      for (size_t c = 0; c < 3; ++c) {
        const auto within = [&](const V(&b)[3]) HWY_ATTR {
          return hn::Add(hn::Add(hn::Mul(part[c][0], b[0]), hn::Mul(part[c][1], b[1])), hn::Mul(part[c][2], b[2]));
        };
        const V middle = within(at);
        const V spread = hn::Add(hn::Mul(wide_u, hn::Abs(within(along_u))), hn::Mul(wide_v, hn::Abs(within(along_v))));
        const V high = hn::Add(middle, spread), low = hn::Sub(middle, spread);
        highest = c == 0 ? high : hn::Max(highest, high);
        lowest = c == 0 ? low : hn::Min(lowest, low);
      }
      const V slack = hn::Mul(error, hn::Add(size, hn::Max(hn::Abs(highest), hn::Abs(lowest))));
      highest = hn::Add(highest, slack);
      lowest = hn::Sub(lowest, slack);
      front = hn::And(front, hn::Ge(highest, zero));
      back = hn::And(back, hn::Le(lowest, zero));
    }
    alive = hn::Or(front, back);
    out.candidates |= MaskBits(d, alive) << lane;
  }
}

/// Pairs of a ray and a triangle that meet. With 16 rays a register: lane i is ray i, `triangle` is the triangle. With
/// four: lane i is ray i / 4 and triangle `triangle` + i % 4.
struct alignas(64) PacketHits {
  float begin[kPacketLanes], end[kPacketLanes];
  float dist_begin[kPacketLanes], dist_end[kPacketLanes];
  uint32_t hit, front, bent, rare, solved;  ///< as in BlockHits
};

/// visible_until: per lane; a triangle all of which is farther is of no interest.
template <size_t kRays>
HWY_INLINE void TestPacket(const PacketTriangles& triangles, size_t triangle, const RayPacket& packet,
                           const float* visible_until, PacketHits& hits) {
  using D = hn::CappedTag<float, kPacketLanes>;
  const D d;
  using V = hn::Vec<D>;
  const auto value = [&](const float* of_triangles) HWY_ATTR {
    if constexpr (kRays == kPacketLanes)
      return hn::Set(d, of_triangles[triangle]);
    else
      return hn::LoadDup128(d, of_triangles + triangle);
  };
  // Lanes of triangles that are no candidates are not looked at.
  uint32_t wanted = (1u << kPacketLanes) - 1;
  if constexpr (kRays != kPacketLanes) wanted = (triangles.candidates >> triangle & 0xf) * 0x1111u;
  hits.hit = hits.front = hits.bent = hits.rare = hits.solved = 0;
  const size_t lanes_used = packet.rays.size() * (kPacketLanes / kRays);
  wanted &= (1u << lanes_used) - 1;
  for (size_t lane = 0; lane < lanes_used; lane += hn::Lanes(d)) {
    const V dist_per_depth = hn::Load(d, packet.dist_per_depth + lane), start = hn::Load(d, packet.start + lane);
    const V nearest = hn::Sub(hn::Mul(dist_per_depth, value(triangles.nearest)), start);
    const auto alive = hn::And(LanesOf(d, wanted >> lane), hn::Le(nearest, hn::Load(d, visible_until + lane)));
    if (hn::AllFalse(d, alive)) continue;
    const V lean_u = hn::Load(d, packet.lean_u + lane), lean_v = hn::Load(d, packet.lean_v + lane);
    QuadraticLanes<D> e[3];
    for (size_t edge = 0; edge < 3; ++edge) {
      const auto coefficient = [&](const PacketTriangles::Term& term) HWY_ATTR {
        return hn::Sub(hn::Sub(value(term.at), hn::Mul(lean_u, value(term.along_u))),
                       hn::Mul(lean_v, value(term.along_v)));
      };
      e[edge].b0 = coefficient(triangles.term[edge][0]);
      e[edge].b1 = coefficient(triangles.term[edge][1]);
      e[edge].b2 = coefficient(triangles.term[edge][2]);
    }
    V key0[3], key1[3];
    for (size_t i = 0; i < 3; ++i) {
      key0[i] = hn::Mul(dist_per_depth, value(triangles.depth[0][i]));
      key1[i] = hn::Mul(dist_per_depth, value(triangles.depth[1][i]));
    }
    if (packet.parallel)
      for (size_t i = 0; i < 3; ++i) {
        key0[i] = hn::Sub(key0[i], start);
        key1[i] = hn::Sub(key1[i], start);
      }
    SolveLanes(d, DistLanes<D>{key0, key1}, e, alive, hn::Le(nearest, hn::Zero(d)), lane, hits);
  }
}

/// Edge functions and distances of one ray and triangle of a packet, the same bits as TestPacket's.
HWY_INLINE void UnpackTriangle(const PacketTriangles& triangles, size_t triangle, const RayPacket& packet, size_t lane,
                               std::array<Quadratic<float>, 3>& edges, FramedTriangle<float>& framed) {
  const auto coefficient = [&](const PacketTriangles::Term& term) {
    return (term.at[triangle] - packet.lean_u[lane] * term.along_u[triangle]) -
           packet.lean_v[lane] * term.along_v[triangle];
  };
  for (size_t edge = 0; edge < 3; ++edge)
    edges[edge] = {coefficient(triangles.term[edge][0]), coefficient(triangles.term[edge][1]),
                   coefficient(triangles.term[edge][2])};
  for (size_t key = 0; key < 2; ++key)
    for (size_t i = 0; i < 3; ++i)
      framed.dist[key][i] = packet.dist_per_depth[lane] * triangles.depth[key][i][triangle] - packet.start[lane];
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
