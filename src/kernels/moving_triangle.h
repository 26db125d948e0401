// A ray against one moving triangle: the scalar reference, in any precision. docs/method.md, "Ray against moving
// triangle".
//
// The vector kernel (trace-inl.h) does the same operations in the same order on eight triangles and calls this code for
// its rare cases, so both give the same bits in the same precision. In double it is the oracle's twin.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <kairos/vec.h>

#include "kernels/ray_frame.h"

namespace kairos {

/// Quadratic in Bernstein form on [0, 1]: b0 (1 - time)^2 + 2 b1 time (1 - time) + b2 time^2.
template <class Real>
struct Quadratic {
  Real b0, b1, b2;

  Real at(Real time) const {
    const Real rest = 1 - time;
    return (rest * rest) * b0 + (2 * (time * rest)) * b1 + (time * time) * b2;
  }
  Quadratic operator-() const { return {-b0, -b1, -b2}; }
};

/// Where a quadratic rises through zero and where it falls, as numbers on the real line; only meaningful where `real`.
/// Negating the quadratic exchanges the two, bit for bit: it is what makes shared edges watertight.
template <class Real>
struct Roots {
  bool real;
  Real rise, fall;
};

template <class Real>
Roots<Real> solve(const Quadratic<Real>& e) {
  const Real h = e.b1 - e.b0;
  const Real a = (e.b0 - e.b1) + (e.b2 - e.b1);
  const Real disc = h * h - a * e.b0;
  const Real root = std::sqrt(std::max(disc, Real(0)));
  const Real q = -(h + std::copysign(root, h));
  const Real first = q / a, second = e.b0 / q;
  return std::signbit(h) ? Roots<Real>{disc > 0, first, second} : Roots<Real>{disc > 0, second, first};
}

/// Vertices at both ends of the key span in the frame of a ray: how far off the ray (u, v) and how far along it (dist).
template <class Real>
struct FramedTriangle {
  Real u[2][3], v[2][3], dist[2][3];  // [key][vertex]
};

/// position[key][vertex], in the space of the ray.
template <class Real>
FramedTriangle<Real> to_frame(const RayFrame<Real>& frame, const std::array<std::array<Vec3f, 3>, 2>& position) {
  FramedTriangle<Real> f;
  for (size_t key = 0; key < 2; ++key)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3f& p = position[key][i];
      const Real w = Real(p[frame.kw]) - Real(frame.origin[frame.kw]);
      f.u[key][i] = (Real(p[frame.ku]) - Real(frame.origin[frame.ku])) - frame.shear_u * w;
      f.v[key][i] = (Real(p[frame.kv]) - Real(frame.origin[frame.kv])) - frame.shear_v * w;
      f.dist[key][i] = frame.inv_w * w;
    }
  return f;
}

/// The side of the edge from vertex i to vertex j on which the ray passes, over time: positive on all three edges when
/// the ray meets the triangle's front. Exchanging i and j negates it bit for bit.
template <class Real>
Quadratic<Real> edge_function(const FramedTriangle<Real>& f, size_t i, size_t j) {
  const auto side = [&](size_t key_i, size_t key_j) {
    return f.v[key_i][i] * f.u[key_j][j] - f.u[key_i][i] * f.v[key_j][j];
  };
  return {side(0, 0), Real(0.5) * (side(0, 1) + side(1, 0)), side(1, 1)};
}

/// Edge i lies opposite vertex i.
template <class Real>
std::array<Quadratic<Real>, 3> edge_functions(const FramedTriangle<Real>& f) {
  return {edge_function(f, 1, 2), edge_function(f, 2, 0), edge_function(f, 0, 1)};
}

/// How far inside a hit its ends' distances are taken where the triangle is seen edge-on there (all edge functions
/// vanish at once, and their ratio with them); and below which share of their largest value that is.
template <class Real>
inline constexpr Real kEdgeOnNudge = sizeof(Real) == 8 ? Real(1e-6) : Real(1e-2);
template <class Real>
inline constexpr Real kEdgeOnShare = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-4);

/// Distance along the ray to the triangle's plane at `time`: sum(e_i dist_i) / sum(e_i), kept within the vertices' own.
template <class Real>
Real distance_at(const FramedTriangle<Real>& f, const std::array<Quadratic<Real>, 3>& e, Real time) {
  Real sum = 0, weight = 0, low = 0, high = 0;
  for (size_t i = 0; i < 3; ++i) {
    const Real dist = f.dist[0][i] + time * (f.dist[1][i] - f.dist[0][i]);
    const Real w = e[i].at(time);
    sum = i == 0 ? w * dist : sum + w * dist;
    weight = i == 0 ? w : weight + w;
    low = i == 0 ? dist : std::min(low, dist);
    high = i == 0 ? dist : std::max(high, dist);
  }
  const Real ratio = sum / weight;
  const Real below = ratio < high ? ratio : high;  // also where the ratio is not a number
  return below > low ? below : low;
}

/// Twice the signed area of the triangle's projection, largest over the span in magnitude of its Bernstein
/// coefficients.
template <class Real>
Real largest_area(const std::array<Quadratic<Real>, 3>& e) {
  return std::max({std::abs(e[0].b0 + e[1].b0 + e[2].b0), std::abs(e[0].b1 + e[1].b1 + e[2].b1),
                   std::abs(e[0].b2 + e[1].b2 + e[2].b2)});
}

/// distance_at an end of a hit; `inside` is the other end.
template <class Real>
Real end_distance(const FramedTriangle<Real>& f, const std::array<Quadratic<Real>, 3>& e, Real end, Real inside) {
  const Real area = std::abs(e[0].at(end) + e[1].at(end) + e[2].at(end));
  const bool edge_on = area < kEdgeOnShare<Real> * largest_area(e);
  return distance_at(f, e, edge_on ? end + kEdgeOnNudge<Real> * (inside - end) : end);
}

/// A stretch of the key span's own time, 0 <= begin < end <= 1, in which a ray meets a triangle.
template <class Real>
struct HitInterval {
  Real begin, end;
  Real dist_begin, dist_end;
  bool front;
};

/// The most stretches in which three edge functions have one sign, each being so in two at most; and the most pieces
/// that the ray's origin cuts one into. Both are what the code below could write if roundings went against it; without
/// them it is seven pieces in all.
inline constexpr size_t kMostStretches = size_t{2} * 2 * 2, kMostPieces = 4;

template <class Real>
struct HitIntervals {
  std::array<HitInterval<Real>, 2 * kMostStretches * kMostPieces> hit;
  int count = 0;
};

namespace detail {

template <class Real>
struct TimeSet {
  std::array<std::pair<Real, Real>, kMostStretches> stretch;
  int count = 0;

  void add(Real begin, Real end) {
    if (begin < end) stretch[static_cast<size_t>(count++)] = {begin, end};
  }
};

/// {time in [0, 1]: e(time) >= 0}.
template <class Real>
TimeSet<Real> where_not_negative(const Quadratic<Real>& e) {
  TimeSet<Real> set;
  const auto clamp01 = [](Real x) { return std::min(std::max(x, Real(0)), Real(1)); };
  const bool in_at_begin = e.b0 >= 0, in_at_end = e.b2 >= 0;
  const Roots<Real> roots = solve(e);
  if (in_at_begin && in_at_end) {
    if (e.b1 < 0 && roots.real) {
      set.add(0, clamp01(roots.fall));
      set.add(clamp01(roots.rise), 1);
    } else {
      set.add(0, 1);
    }
  } else if (in_at_begin || in_at_end || (e.b1 > 0 && roots.real)) {
    set.add(in_at_begin ? Real(0) : clamp01(roots.rise), in_at_end ? Real(1) : clamp01(roots.fall));
  }
  return set;
}

template <class Real>
TimeSet<Real> intersect(const TimeSet<Real>& a, const TimeSet<Real>& b) {
  TimeSet<Real> set;
  for (size_t i = 0; i < static_cast<size_t>(a.count); ++i)
    for (size_t j = 0; j < static_cast<size_t>(b.count); ++j)
      set.add(std::max(a.stretch[i].first, b.stretch[j].first), std::min(a.stretch[i].second, b.stretch[j].second));
  if (set.count == 2 && set.stretch[1].first < set.stretch[0].first) std::swap(set.stretch[0], set.stretch[1]);
  return set;
}

/// Where in (begin, end) a triangle passes the ray's origin: the sign changes of sum(e_i dist_i), a cubic, found by
/// sampling between the extrema of its derivative and bisection. Rare: only triangles with vertices on both sides of
/// the origin.
template <class Real>
std::array<Real, kMostPieces + 1> split_at_origin(const FramedTriangle<Real>& f,
                                                  const std::array<Quadratic<Real>, 3>& e, Real begin, Real end,
                                                  int& count) {
  const auto cubic = [&](double time) {
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Quadratic<double> w{e[i].b0, e[i].b1, e[i].b2};
      sum += w.at(time) * (f.dist[0][i] + time * (double(f.dist[1][i]) - f.dist[0][i]));
    }
    return sum;
  };
  // Bernstein coefficients of the cubic, then of its derivative.
  double c[4] = {};
  for (size_t i = 0; i < 3; ++i) {
    const double z0 = f.dist[0][i], z1 = f.dist[1][i];
    c[0] += e[i].b0 * z0;
    c[1] += (e[i].b0 * z1 + 2.0 * e[i].b1 * z0) / 3;
    c[2] += (2.0 * e[i].b1 * z1 + e[i].b2 * z0) / 3;
    c[3] += e[i].b2 * z1;
  }
  const Roots<double> extrema = solve(Quadratic<double>{c[1] - c[0], c[2] - c[1], c[3] - c[2]});
  std::array<double, 4> stop{double(begin), double(end), double(end), double(end)};
  size_t stops = 1;
  if (extrema.real) {
    const double low = std::min(extrema.rise, extrema.fall), high = std::max(extrema.rise, extrema.fall);
    if (low > begin && low < end) stop[stops++] = low;
    if (high > begin && high < end) stop[stops++] = high;
  }
  stop[stops] = double(end);
  std::array<Real, kMostPieces + 1> cut{begin};
  count = 1;
  for (size_t s = 0; s < stops; ++s) {
    double a = stop[s], b = stop[s + 1];
    const bool positive = cubic(a) > 0;
    if (positive == (cubic(b) > 0)) continue;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (a + b);
      ((cubic(middle) > 0) == positive ? a : b) = middle;
    }
    cut[static_cast<size_t>(count++)] = static_cast<Real>(b);
  }
  cut[static_cast<size_t>(count)] = end;
  return cut;
}

}  // namespace detail

/// All stretches of [0, 1] in which the ray meets the triangle at a positive distance, those seen from the front first,
/// each side in time order. Not-a-number in the input gives no hit, or hits with times that still are within [0, 1].
/// `edges`: as edge_functions gives them, or computed otherwise; then f.u and f.v are not looked at.
template <class Real>
HitIntervals<Real> intersect_moving_triangle(const FramedTriangle<Real>& f,
                                             const std::array<Quadratic<Real>, 3>& edges) {
  HitIntervals<Real> out;
  Real nearest = f.dist[0][0], farthest = f.dist[0][0];
  for (size_t key = 0; key < 2; ++key)
    for (size_t i = 0; i < 3; ++i) {
      nearest = std::min(nearest, f.dist[key][i]);
      farthest = std::max(farthest, f.dist[key][i]);
    }
  if (!(farthest > 0)) return out;
  if (largest_area(edges) == 0) return out;  // edge-on or without area at all times

  const auto add = [&](Real begin, Real end, bool front, const std::array<Quadratic<Real>, 3>& e) {
    if (!(begin < end)) return;
    out.hit[static_cast<size_t>(out.count++)] = {begin, end, end_distance(f, e, begin, end),
                                                 end_distance(f, e, end, begin), front};
  };
  for (const bool front : {true, false}) {
    std::array<Quadratic<Real>, 3> e = edges;
    if (!front) e = {-edges[0], -edges[1], -edges[2]};
    auto set = detail::where_not_negative(e[0]);
    set = detail::intersect(set, detail::where_not_negative(e[1]));
    set = detail::intersect(set, detail::where_not_negative(e[2]));
    for (size_t s = 0; s < static_cast<size_t>(set.count); ++s) {
      const auto [begin, end] = set.stretch[s];
      if (nearest > 0) {
        add(begin, end, front, e);
        continue;
      }
      int count = 0;
      const auto cut = detail::split_at_origin(f, e, begin, end, count);
      for (size_t c = 0; c < static_cast<size_t>(count); ++c)
        if (distance_at(f, e, Real(0.5) * (cut[c] + cut[c + 1])) > 0) add(cut[c], cut[c + 1], front, e);
    }
  }
  return out;
}

template <class Real>
HitIntervals<Real> intersect_moving_triangle(const FramedTriangle<Real>& f) {
  return intersect_moving_triangle(f, edge_functions(f));
}

}  // namespace kairos
