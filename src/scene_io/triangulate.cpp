#include "scene_io/triangulate.h"

#include <cmath>

namespace kairos {

namespace {

/// Twice the signed area of the triangle a, b, c.
double area2(Vec2d a, Vec2d b, Vec2d c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// The polygon's vector area times two (Newell): its direction is the mean plane's normal.
Vec3d vector_area(std::span<const Vec3f> points) {
  const Vec3d origin = to_double(points[0]);
  Vec3d sum;
  for (size_t i = 1; i + 1 < points.size(); ++i)
    sum += cross(to_double(points[i]) - origin, to_double(points[i + 1]) - origin);
  return sum;
}

/// Points in the coordinate plane that the polygon faces most, wound counter-clockwise.
std::vector<Vec2d> flatten(std::span<const Vec3f> points, Vec3d normal) {
  const Vec3d size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Vec2d> flat(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3d p = to_double(points[i]);
    flat[i] = normal[axis] > 0 ? Vec2d{p[u], p[v]} : Vec2d{p[v], p[u]};
  }
  return flat;
}

bool is_convex(const std::vector<Vec2d>& p) {
  const size_t n = p.size();
  for (size_t i = 0; i < n; ++i)
    if (area2(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0) return false;
  // Corners that all turn left may still go round more than once (a star): then the fan turns back somewhere.
  for (size_t i = 1; i + 1 < n; ++i)
    if (area2(p[0], p[i], p[i + 1]) < 0) return false;
  return true;
}

void fan(uint32_t corners, std::vector<Triangle>& out) {
  for (uint32_t i = 1; i + 1 < corners; ++i) out.push_back({0, i, i + 1});
}

/// What is left of a polygon while its ears are cut off: a ring of corners.
class Ring {
 public:
  explicit Ring(const std::vector<Vec2d>& points) : points_(points), next_(points.size()), prev_(points.size()) {
    const auto n = static_cast<uint32_t>(points.size());
    for (uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      prev_[i] = (i + n - 1) % n;
    }
  }

  uint32_t next(uint32_t i) const { return next_[i]; }
  Triangle corner(uint32_t i) const { return {prev_[i], i, next_[i]}; }

  /// An ear is a corner that turns left and whose triangle no other corner of the ring lies in.
  bool is_ear(uint32_t i) {
    const Vec2d a = points_[prev_[i]], b = points_[i], c = points_[next_[i]];
    if (!(area2(a, b, c) > 0)) return false;
    for (uint32_t k = next_[next_[i]]; k != prev_[i]; k = next_[k]) {
      const Vec2d p = points_[k];
      ++tests_;
      if (p == a || p == b || p == c) continue;  // a hole joined by a double edge visits its ends twice
      if (area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0) return false;
    }
    return true;
  }

  size_t tests() const { return tests_; }

  void cut(uint32_t i) {
    next_[prev_[i]] = next_[i];
    prev_[next_[i]] = prev_[i];
  }

 private:
  const std::vector<Vec2d>& points_;
  std::vector<uint32_t> next_, prev_;
  size_t tests_ = 0;
};

void cut_ears(const std::vector<Vec2d>& points, std::vector<Triangle>& out) {
  // Simple polygons need far fewer tests; one made to waste time stops looking for ears.
  const size_t budget = 8 * points.size() * points.size();
  Ring ring(points);
  uint32_t corner = 1;
  size_t tried = 0;
  for (size_t left = points.size(); left > 2;) {
    // Every simple polygon has an ear; one that meets itself may have none, and then any corner will do.
    if (tried >= left || ring.tests() > budget || ring.is_ear(corner)) {
      out.push_back(ring.corner(corner));
      ring.cut(corner);
      --left;
      tried = 0;
    } else {
      ++tried;
    }
    corner = ring.next(corner);
  }
}

}  // namespace

bool triangulate_polygon(std::span<const Vec3f> points, std::vector<Triangle>& out) {
  if (points.size() < 3) return true;
  const auto corners = static_cast<uint32_t>(points.size());
  const Vec3d normal = corners > 3 ? vector_area(points) : Vec3d{};
  if (corners == 3 || !is_finite(normal) || normal == Vec3d{}) {
    fan(corners, out);
    return true;
  }
  const std::vector<Vec2d> flat = flatten(points, normal);
  const bool convex = is_convex(flat);
  if (convex || corners > kMaxConcaveCorners) {
    fan(corners, out);
    return convex;
  }
  cut_ears(flat, out);
  return true;
}

}  // namespace kairos
