#include "motion/motion_mask.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace kairos {

namespace {

constexpr size_t kRowsPerTask = 32, kColumnsPerTask = 512;

size_t cells_of(int pixels) { return (static_cast<size_t>(pixels) + kDirectionCell - 1) / kDirectionCell; }

/// From differences at corners to sums.
template <class Sums, class Add>
void sum_up(std::vector<Sums>& plane, size_t columns, const Add& add) {
  const size_t rows = plane.size() / columns;
  parallel_for(rows, kRowsPerTask, [&](size_t first, size_t last) {
    for (size_t y = first; y < last; ++y)
      for (size_t x = 1; x < columns; ++x) add(plane[y * columns + x], plane[y * columns + x - 1], 1);
  });
  parallel_for(columns, kColumnsPerTask, [&](size_t first, size_t last) {
    for (size_t y = 1; y < rows; ++y)
      for (size_t x = first; x < last; ++x) add(plane[y * columns + x], plane[(y - 1) * columns + x], 1);
  });
}

/// Adds what holds in [x0, x1) x [y0, y1) to differences.
template <class Sums, class Add>
void add_differences(std::vector<Sums>& plane, size_t columns, size_t x0, size_t x1, size_t y0, size_t y1,
                     const Sums& value, const Add& add) {
  add(plane[y0 * columns + x0], value, 1);
  add(plane[y0 * columns + x1], value, -1);
  add(plane[y1 * columns + x0], value, -1);
  add(plane[y1 * columns + x1], value, 1);
}

constexpr auto kAddPixel = [](auto& to, const auto& from, int64_t sign) {
  to.count += sign * from.count;
  to.speed += sign * from.speed;
  to.depth += sign * from.depth;
};
constexpr auto kAddCell = [](auto& to, const auto& from, int64_t sign) {
  to.along += sign * from.along;
  to.across += sign * from.across;
  to.weight += sign * from.weight;
};

}  // namespace

MotionMask::MotionMask(std::shared_ptr<const ScreenMotion> shared, const Crop& part) : motion_(std::move(shared)) {
  const ScreenMotion& motion = *motion_;
  const auto before = [](int pixel) { return pixel / kDirectionCell * kDirectionCell; };
  const auto after = [&](int pixel, int end) { return std::min(before(pixel + kDirectionCell - 1), end); };
  part_ = {before(part.x0), after(part.x1, motion.frame().width), before(part.y0),
           after(part.y1, motion.frame().height)};
  columns_ = static_cast<size_t>(part_.x1 - part_.x0) + 1;
  cell_columns_ = cells_of(part_.x1 - part_.x0) + 1;
  if (motion.empty()) return;
  pixels_.resize(columns_ * (static_cast<size_t>(part_.y1 - part_.y0) + 1));
  cells_.resize(cell_columns_ * (cells_of(part_.y1 - part_.y0) + 1));
  motion.visit(part_, [&](std::span<const TriangleOnScreen> triangles) {
    for (const TriangleOnScreen& triangle : triangles) add(triangle);
  });
  sum_up(pixels_, columns_, kAddPixel);
  sum_up(cells_, cell_columns_, kAddCell);
}

void MotionMask::add(const TriangleOnScreen& triangle) {
  const int x0 = std::max(triangle.pixels.x0, part_.x0) - part_.x0;
  const int x1 = std::min(triangle.pixels.x1, part_.x1) - part_.x0;
  const int y0 = std::max(triangle.pixels.y0, part_.y0) - part_.y0;
  const int y1 = std::min(triangle.pixels.y1, part_.y1) - part_.y0;
  if (x0 >= x1 || y0 >= y1) return;
  add_differences(pixels_, columns_, static_cast<size_t>(x0), static_cast<size_t>(x1), static_cast<size_t>(y0),
                  static_cast<size_t>(y1), InPixel{1, triangle.speed, triangle.depth}, kAddPixel);
  add_differences(cells_, cell_columns_, static_cast<size_t>(x0 / kDirectionCell), cells_of(x1),
                  static_cast<size_t>(y0 / kDirectionCell), cells_of(y1),
                  InCell{triangle.along, triangle.across, triangle.weight}, kAddCell);
}

PixelMotion MotionMask::at(int x, int y) const {
  if (x < part_.x0 || x >= part_.x1 || y < part_.y0 || y >= part_.y1) {
    const PixelMotion* look = motion_->at_look(x, y);
    return look != nullptr ? *look : PixelMotion{};
  }
  if (pixels_.empty()) return {};
  const auto column = static_cast<size_t>(x - part_.x0), row = static_cast<size_t>(y - part_.y0);
  const InPixel& pixel = pixels_[row * columns_ + column];
  const InCell& cell = cells_[row / kDirectionCell * cell_columns_ + column / kDirectionCell];
  return {pixel.count, pixel.speed, pixel.depth, cell.along, cell.across, cell.weight};
}

}  // namespace kairos
