#include "events/edge_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <kairos/record.h>

namespace kairos {

namespace {

/// An edge that is farther from the film point, in pixels, is not the one that passes it.
constexpr double kNear = 0.02;
/// How far a time found by the kernels may be off, in shutter time: float arithmetic on grazing edges.
constexpr double kMostShift = 1e-3;
/// Step of a difference in time: small against any motion, large against rounding.
constexpr double kStep = 1e-6;
/// Slower edges rest, pixels per shutter time.
constexpr double kRest = 1e-3;

/// Of a triangle in one of its key spans.
struct MovingCorners {
  std::array<Vec3d, 3> at, velocity;  // at `time`; per shutter time
  double time;

  MovingCorners(const Mesh& mesh, uint32_t triangle, double when) : time(when) {
    const Triangle& corners = mesh.triangle(triangle);
    if (mesh.is_static()) {
      for (size_t i = 0; i < 3; ++i) at[i] = to_double(mesh.position(0, corners[i]));
      velocity = {};
      return;
    }
    const auto after = std::upper_bound(mesh.key_times.begin() + 1, mesh.key_times.end() - 1, static_cast<float>(when));
    const auto key = static_cast<size_t>(after - mesh.key_times.begin());
    const double begin = mesh.key_times[key - 1], end = mesh.key_times[key];
    const double length = std::max(end - begin, std::numeric_limits<double>::min());
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d from = to_double(mesh.position(key - 1, corners[i])), to = to_double(mesh.position(key, corners[i]));
      velocity[i] = (to - from) / length;
      at[i] = from + velocity[i] * (when - begin);
    }
  }

  Vec3d corner(size_t i, double when) const { return at[i] + velocity[i] * (when - time); }
};

/// The ray through a film point: its origin has no depth, or its direction no slope.
struct FilmRay {
  Vec3d origin{}, direction{0, 0, -1};

  FilmRay(const FilmPlane& plane, double x, double y) {
    const Vec2d point = plane.at(x, y);
    (plane.orthographic() ? origin : direction) = {point.x, point.y, plane.orthographic() ? 0.0 : -1.0};
  }
};

/// Zero on the line through two corners, and affine over the film: the volume that they span with the ray.
double edge_side(const FilmRay& ray, const Vec3d& a, const Vec3d& b) {
  return dot(ray.direction, cross(a - ray.origin, b - ray.origin));
}

/// Affine over the film: for a perspective view one over the distance to a triangle's plane, for a parallel one the
/// distance, with its sign changed so that what is nearer is larger in both.
double nearness(const FilmRay& ray, const MovingCorners& triangle, double time, bool orthographic) {
  const Vec3d a = triangle.corner(0, time);
  const Vec3d normal = cross(triangle.corner(1, time) - a, triangle.corner(2, time) - a);
  const double along = dot(normal, ray.direction), across = dot(normal, a - ray.origin);
  return orthographic ? -across / along : along / across;
}

/// side(x, y, time): affine over the film, zero on the line.
template <class Side>
std::optional<EdgeMotion> motion_of(const Side& side, double x, double y, double time) {
  const double value = side(x, y, time);
  Vec2d gradient{side(x + 1, y, time) - value, side(x, y + 1, time) - value};
  const double length = std::hypot(gradient.x, gradient.y);
  if (!(length > 0) || !std::isfinite(length) || !(std::abs(value) < kNear * length)) return std::nullopt;
  EdgeMotion edge{time, {}, 0};
  double rate = 0;
  constexpr int kRounds = 3;  // of Newton's method, from a start that is good to single precision
  for (int round = 0; round < kRounds; ++round) {
    rate = (side(x, y, edge.time + kStep) - side(x, y, edge.time - kStep)) / (2 * kStep);
    if (!(std::abs(rate) > kRest * length)) return std::nullopt;
    edge.time = std::clamp(edge.time - side(x, y, edge.time) / rate, time - kMostShift, time + kMostShift);
  }
  edge.speed = std::abs(rate) / length;
  // Its own side grows where it comes from; turned so that it moves along its normal.
  const double sign = rate > 0 ? -1 : 1;
  edge.normal = {sign * gradient.x / length, sign * gradient.y / length};
  return edge;
}

}  // namespace

bool EdgeFinder::arrives(const Segment& before, const Segment& after) {
  const auto dist_of = [](const Segment& segment, float dist) {
    return segment.mesh == kNoMesh ? std::numeric_limits<float>::infinity() : dist;
  };
  return dist_of(after, after.dist_begin) < dist_of(before, before.dist_end);
}

std::optional<EdgeMotion> EdgeFinder::find(double x, double y, double time, const Segment& before,
                                           const Segment& after) const {
  const bool is_new = arrives(before, after);
  const Segment &front = is_new ? after : before, &back = is_new ? before : after;
  if (front.mesh == kNoMesh) return std::nullopt;
  const MovingCorners triangle(shot_.meshes[front.mesh], front.triangle, time);
  // The edge on whose line the point lies.
  size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto side = [&](size_t edge, double film_x, double film_y, double when) {
    return edge_side(FilmRay(plane_, film_x, film_y), triangle.corner(edge, when),
                     triangle.corner((edge + 1) % 3, when));
  };
  for (size_t edge = 0; edge < 3; ++edge) {
    const double value = side(edge, x, y, time);
    const double length = std::hypot(side(edge, x + 1, y, time) - value, side(edge, x, y + 1, time) - value);
    if (std::abs(value) < least * length) {
      least = std::abs(value) / length;
      nearest = edge;
    }
  }
  if (auto edge = motion_of(
          [&](double film_x, double film_y, double when) { return side(nearest, film_x, film_y, when); }, x, y, time))
    return edge;
  if (back.mesh == kNoMesh || least < kNear) return std::nullopt;
  const MovingCorners other(shot_.meshes[back.mesh], back.triangle, time);
  return motion_of(
      [&](double film_x, double film_y, double when) {
        const FilmRay ray(plane_, film_x, film_y);
        return nearness(ray, triangle, when, plane_.orthographic()) - nearness(ray, other, when, plane_.orthographic());
      },
      x, y, time);
}

SurfacePoint EdgeFinder::point(double x, double y, double time, const Segment& seen) const {
  const MovingCorners triangle(shot_.meshes[seen.mesh], seen.triangle, time);
  const FilmRay ray(plane_, x, y);
  // A corner's share of the point is the volume that the ray spans with the other two, of the sum. Of a triangle that
  // is seen from the side they are rounding alone: so the point stays within it.
  std::array<double, 3> share{};
  double sum = 0;
  for (size_t i = 0; i < 3; ++i) {
    share[i] = edge_side(ray, triangle.at[(i + 1) % 3], triangle.at[(i + 2) % 3]);
    sum += share[i];
  }
  const double sign = sum < 0 ? -1 : 1;
  sum = 0;
  for (double& part : share) sum += part = std::max(sign * part, 0.0);
  if (!(sum > 0)) sum = share[0] = 1;
  Vec3d at{}, velocity{};
  for (size_t i = 0; i < 3; ++i) {
    at = at + triangle.at[i] * (share[i] / sum);
    velocity = velocity + triangle.velocity[i] * (share[i] / sum);
  }
  const double depth = -at.z, scale = plane_.orthographic() ? 1 : depth;
  const Vec2d here = plane_.at(x, y);
  const double toward = plane_.orthographic() ? 0 : velocity.z;
  constexpr double kShort = 1e-3;  // any length will do: the film is affine
  const Vec2d moved = plane_.film({here.x + kShort * (velocity.x + here.x * toward) / scale,
                                   here.y + kShort * (velocity.y + here.y * toward) / scale});
  return {depth, {(moved.x - x) / kShort, (moved.y - y) / kShort}};
}

}  // namespace kairos
