// Moving boxes as four vectors of four lanes: what the builder computes with.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace kairos {

/// A vector of both compilers; comparisons give lanes of -1 or 0, and select by lane.
using Lanes = float __attribute__((vector_size(16)));
using IntLanes = int32_t __attribute__((vector_size(16)));

inline Lanes all_lanes(float value) { return Lanes{value, value, value, value}; }
/// Of the second one, where the first is no number.
inline Lanes lower_of(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes higher_of(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes square_roots(Lanes a) {
#ifdef __SSE2__
  return _mm_sqrt_ps(a);
#else
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}
/// In each lane the sum of the other three.
inline Lanes sum_of_others(Lanes a) {
  return (__builtin_shufflevector(a, a, 1, 2, 3, 0) + __builtin_shufflevector(a, a, 3, 0, 1, 2)) +
         __builtin_shufflevector(a, a, 2, 3, 0, 1);
}
/// Zero in the fourth lane.
inline Lanes three_lanes(Lanes a) {
  constexpr IntLanes kKept{-1, -1, -1, 0};
  return std::bit_cast<Lanes>(std::bit_cast<IntLanes>(a) & kKept);
}

/// A box whose faces move linearly. The upper bounds are negated, so that a union is a minimum. The fourth lane of each
/// vector is no part of the box.
struct alignas(64) BoxLanes {
  std::array<Lanes, 4> bound;  ///< lower at begin, -upper at begin, lower at end, -upper at end

  static BoxLanes empty() {
    const Lanes infinity = all_lanes(std::numeric_limits<float>::infinity());
    return {{infinity, infinity, infinity, infinity}};
  }
  void include(const BoxLanes& other) {
    for (size_t i = 0; i < bound.size(); ++i) bound[i] = lower_of(other.bound[i], bound[i]);
  }
  /// key 0: begin, 1: end.
  float lower(int key, int axis) const { return bound[static_cast<size_t>(2 * key)][axis]; }
  float upper(int key, int axis) const { return -bound[static_cast<size_t>(2 * key + 1)][axis]; }

  /// Cost of a node, in units of an eighth of a surface. First term: the volume swept by a box of the mean size that
  /// moves with the centre, proportional to the probability that a random line meets the box at *any* time. It is the
  /// Minkowski sum of a box (edges a, b, c) and a motion m, a zonotope whose faces come in pairs |g_i x g_j| of its
  /// four generators. Second term, at half the weight: the mean box, proportional to the time for which the line does.
  /// Where boxes cross each other's paths the first cannot tell whether they are kept apart (docs/method.md,
  /// "Builder").
  float cost() const {
    const Lanes edge = three_lanes(-((bound[0] + bound[1]) + (bound[2] + bound[3])));  // twice the mean
    const Lanes move = three_lanes((bound[2] - bound[3]) - (bound[0] - bound[1]));     // twice the centre's
    // The sum over the lanes counts each pair of edges twice.
    const Lanes terms = edge * (all_lanes(0.75f) * sum_of_others(edge) + square_roots(sum_of_others(move * move)));
    return (terms[0] + terms[1]) + terms[2];
  }
};

/// Twice the centre, averaged over time, and twice the centre's displacement: what splits sort by, so that things in
/// one place that move differently part company. The fourth lane is 0.
struct SortValues {
  Lanes place, velocity;

  explicit SortValues(const BoxLanes& box) {
    const Lanes begin = three_lanes(box.bound[0] - box.bound[1]), end = three_lanes(box.bound[2] - box.bound[3]);
    place = all_lanes(0.5f) * (begin + end);
    velocity = end - begin;
  }
};

/// A triangle of a mesh.
struct TriangleId {
  uint32_t mesh, triangle;
};

/// A triangle to be put into a tree: one cache line. Lanes that are no part of the box hold the id.
struct Primitive {
  BoxLanes box;

  void set_id(TriangleId id) {
    box.bound[0][3] = std::bit_cast<float>(id.mesh);
    box.bound[2][3] = std::bit_cast<float>(id.triangle);
    box.bound[1][3] = box.bound[3][3] = 0;
  }
  TriangleId id() const { return {std::bit_cast<uint32_t>(box.bound[0][3]), std::bit_cast<uint32_t>(box.bound[2][3])}; }
};

}  // namespace kairos
