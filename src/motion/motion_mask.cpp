#include "motion/motion_mask.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

/// Pixels per shutter are kept as integers, so that sums do not depend on their order.
constexpr double kSpeedUnits = 64;
/// No single triangle decides about the direction of many.
constexpr double kHighestWeight = 1e3;
/// Motion whose directions agree to this share, 0 to 1, has one: all within about 20 degrees.
constexpr double kLeastAgreement = 0.9;
/// So are binary logarithms of depths, from 2^-kDepthRange to 2^kDepthRange.
constexpr double kDepthUnits = 4096, kDepthRange = 40;
/// Faster than this counts as this: paths that pass the camera have no bound on screen.
constexpr double kHighestSpeed = 1e6;
/// Nothing nearer than this part of the farther end of an edge is projected: an edge that passes the camera plane is
/// cut there. What lies in front of it covers the screen all the same, by the cut's own place far outside.
constexpr double kNearShare = 1e-6;

struct ScreenBounds {
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  void include(Vec2d p) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
};

class ToScreen {
 public:
  explicit ToScreen(const Projection& p)
      : orthographic_(p.orthographic),
        half_height_(p.orthographic ? p.view_height / 2 : std::tan(p.vfov / 2)),
        width_(p.width),
        height_(p.height) {}

  bool is_in_front(Vec3d p) const { return p.z < 0; }

  Vec2d operator()(Vec3d p) const {
    const double scale = (orthographic_ ? 1 : 1 / -p.z) / half_height_ * height_ / 2;
    return {width_ / 2 + p.x * scale, height_ / 2 - p.y * scale};
  }

 private:
  bool orthographic_;
  double half_height_, width_, height_;
};

/// Bounds of the convex hull of `points` in front of the camera: a path between two keys stays inside the hull of its
/// ends.
template <size_t N>
ScreenBounds bounds_of_hull(const std::array<Vec3d, N>& points, const ToScreen& to_screen) {
  ScreenBounds bounds;
  for (const Vec3d& p : points)
    if (to_screen.is_in_front(p)) bounds.include(to_screen(p));
  for (const Vec3d& front : points) {
    if (!to_screen.is_in_front(front)) continue;
    for (const Vec3d& behind : points) {
      if (to_screen.is_in_front(behind)) continue;
      const double z = front.z * kNearShare, weight = (z - front.z) / (behind.z - front.z);
      Vec3d cut = lerp(front, behind, weight);
      cut.z = z;
      bounds.include(to_screen(cut));
    }
  }
  return bounds;
}

}  // namespace

MotionMask::MotionMask(const Shot& shot, double margin)
    : width_(shot.projection.width), height_(shot.projection.height) {
  const size_t columns = static_cast<size_t>(width_) + 1, rows = static_cast<size_t>(height_) + 1;
  count_.assign(columns * rows, 0);
  speed_.assign(columns * rows, 0);
  depth_.assign(columns * rows, 0);
  const size_t cell_columns = cells(width_), cell_rows = cells(height_);
  along_.assign(cell_columns * cell_rows, 0);
  across_.assign(cell_columns * cell_rows, 0);
  weight_.assign(cell_columns * cell_rows, 0);
  const ToScreen to_screen(shot.projection);
  for (const Mesh& mesh : shot.meshes) {
    if (mesh.is_static()) continue;
    for (const Triangle& triangle : mesh.triangles)
      for (size_t key = 0; key + 1 < mesh.key_count(); ++key) {
        if (mesh.key_times[key] == mesh.key_times[key + 1]) continue;
        std::array<Vec3d, 6> points;
        double path = 0, nearest = INFINITY;
        Vec2d longest;  // of the paths on screen
        for (size_t v = 0; v < 3; ++v) {
          points[v] = to_double(mesh.positions[key][triangle[v]]);
          points[v + 3] = to_double(mesh.positions[key + 1][triangle[v]]);
          nearest = std::min({nearest, -points[v].z, -points[v + 3].z});
          if (!to_screen.is_in_front(points[v]) || !to_screen.is_in_front(points[v + 3])) {
            path = kHighestSpeed;
            longest = {};  // of no direction
          } else {
            const Vec2d a = to_screen(points[v]), b = to_screen(points[v + 3]);
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            if (length <= path) continue;
            path = length;
            longest = {b.x - a.x, b.y - a.y};
          }
        }
        const ScreenBounds b = bounds_of_hull(points, to_screen);
        const auto column = [&](double x) {
          return static_cast<size_t>(std::clamp(x, 0.0, static_cast<double>(width_)));
        };
        const auto row = [&](double y) {
          return static_cast<size_t>(std::clamp(y, 0.0, static_cast<double>(height_)));
        };
        if (!(b.x0 <= b.x1) || b.x1 + margin < 0 || b.x0 - margin > width_ || b.y1 + margin < 0 ||
            b.y0 - margin > height_)
          continue;
        const size_t x0 = column(std::floor(b.x0 - margin)), x1 = column(std::floor(b.x1 + margin) + 1);
        const size_t y0 = row(std::floor(b.y0 - margin)), y1 = row(std::floor(b.y1 + margin) + 1);
        const double duration = static_cast<double>(mesh.key_times[key + 1]) - static_cast<double>(mesh.key_times[key]);
        const int64_t speed = std::llround(std::min(path / duration, kHighestSpeed) * kSpeedUnits);
        const double logarithm = nearest > 0 ? std::log2(nearest) : -kDepthRange;
        const int64_t depth = std::llround(std::clamp(logarithm, -kDepthRange, kDepthRange) * kDepthUnits);
        // Of a line's direction, twice its angle is what can be added up: there and back are one direction.
        const double length_2 = longest.x * longest.x + longest.y * longest.y;
        const double weight = length_2 > 0 ? std::min(path / duration, kHighestWeight) * kSpeedUnits : 0;
        const double share = length_2 > 0 ? weight / length_2 : 0;
        const int64_t along = std::llround(share * (longest.x * longest.x - longest.y * longest.y));
        const int64_t across = std::llround(share * 2 * longest.x * longest.y), whole = std::llround(weight);
        any_ = true;
        const auto add = [&](size_t x, size_t y, int sign) {
          count_[y * columns + x] += sign;
          speed_[y * columns + x] += sign * speed;
          depth_[y * columns + x] += sign * depth;
        };
        add(x0, y0, 1);
        add(x1, y0, -1);
        add(x0, y1, -1);
        add(x1, y1, 1);
        const auto add_direction = [&](size_t x, size_t y, int sign) {
          along_[y * cell_columns + x] += sign * along;
          across_[y * cell_columns + x] += sign * across;
          weight_[y * cell_columns + x] += sign * whole;
        };
        const auto after = [](size_t pixel) { return (pixel + kCell - 1) / kCell; };
        add_direction(x0 / kCell, y0 / kCell, 1);
        add_direction(after(x1), y0 / kCell, -1);
        add_direction(x0 / kCell, after(y1), -1);
        add_direction(after(x1), after(y1), 1);
      }
  }
  sum_up(count_, columns);
  for (std::vector<int64_t>* plane : {&speed_, &depth_}) sum_up(*plane, columns);
  for (std::vector<int64_t>* plane : {&along_, &across_, &weight_}) sum_up(*plane, cell_columns);
}

template <class Number>
void MotionMask::sum_up(std::vector<Number>& plane, size_t columns) {
  const size_t rows = plane.size() / columns;
  for (size_t y = 0; y < rows; ++y)
    for (size_t x = 1; x < columns; ++x) plane[y * columns + x] += plane[y * columns + x - 1];
  for (size_t y = 1; y < rows; ++y)
    for (size_t x = 0; x < columns; ++x) plane[y * columns + x] += plane[(y - 1) * columns + x];
}

std::optional<double> MotionMask::direction(int x, int y) const {
  const size_t cell = static_cast<size_t>(y) / kCell * cells(width_) + static_cast<size_t>(x) / kCell;
  const auto along = static_cast<double>(along_[cell]), across = static_cast<double>(across_[cell]);
  const auto weight = static_cast<double>(weight_[cell]);
  if (!(weight > 0) || std::hypot(along, across) < kLeastAgreement * weight) return std::nullopt;
  return 0.5 * std::atan2(across, along);
}

double MotionMask::speed(int x, int y) const {
  const int32_t count = at(count_, x, y);
  return count == 0 ? 0 : static_cast<double>(at(speed_, x, y)) / kSpeedUnits / count;
}

double MotionMask::depth(int x, int y) const {
  const int32_t count = at(count_, x, y);
  return count == 0 ? INFINITY : std::exp2(static_cast<double>(at(depth_, x, y)) / kDepthUnits / count);
}

}  // namespace kairos
