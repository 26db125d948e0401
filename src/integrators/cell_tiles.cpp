#include "integrators/cell_tiles.h"

#include <algorithm>

#include "math/hash.h"

namespace kairos {

namespace {

/// In small pictures they are smaller, so that there is something to do for many threads.
constexpr int kLargestSquare = 64, kSmallestSquare = 32, kLeastSquares = 64;
/// Of squares: what they hold takes about 150 bytes each.
constexpr double kMostLookUps = 1 << 19;
constexpr uint64_t kTileDimension = 0x74696c65;

int square_count(const CellPlan& plan) {
  const auto along = [&](int length) { return (length + plan.side - 1) / plan.side; };
  return along(plan.frame_width) * along(plan.frame_height);
}

}  // namespace

CellPlan plan_cells(const Shot& shot, const RenderParams& params, const std::optional<CellOptions>& cells,
                    double look_ups) {
  CellPlan plan;
  if (!cells) return plan;
  plan.frame_width = shot.projection.width;
  plan.frame_height = shot.projection.height;
  plan.seed = params.seed;
  plan.cells = *cells;
  plan.side = kLargestSquare;
  while (plan.side > kSmallestSquare && square_count(plan) < kLeastSquares) plan.side /= 2;
  while (plan.side > 1 && look_ups * plan.side * plan.side > kMostLookUps) plan.side /= 2;
  return plan;
}

std::unique_ptr<Integrator::Worker> make_cell_worker(const CellPlan& plan, const PixelContext& context,
                                                     const MakeWorker& make_worker) {
  if (plan.side == 0) return make_worker(nullptr);
  return std::make_unique<CellTileWorker>(plan, context, make_worker);
}

CellTileWorker::CellTileWorker(const CellPlan& plan, const PixelContext& context, const MakeWorker& make_worker)
    : plan_(plan),
      keep_surfaces_(context.needs.surfaces()),
      worker_(make_worker(&look_ups_)),
      cells_(context.shader, plan.cells) {}

const PixelRecord& CellTileWorker::render_pixel(int x, int y, Monitor& monitor) {
  const int left = x - x % plan_.side, top = y - y % plan_.side;
  if (left != left_ || top != top_) render_tile(left, top, monitor);
  const int place = (y - top) * (right_ - left) + (x - left);
  return record_ = tile_.record(static_cast<size_t>(place), x, y);
}

void CellTileWorker::render_tile(int left, int top, Monitor& monitor) {
  left_ = -1;  // until it is whole
  right_ = std::min(left + plan_.side, plan_.frame_width);
  const int bottom = std::min(top + plan_.side, plan_.frame_height);
  tile_.clear();
  look_ups_.clear();
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right_; ++x) {
      tile_.add(worker_->render_pixel(x, y, monitor), keep_surfaces_);
      look_ups_.end_pixel(tile_.first_knot[tile_.pixels() - 1]);
    }
  const uint64_t seed = hash(plan_.seed, kTileDimension, static_cast<uint64_t>(left), static_cast<uint64_t>(top));
  const std::span<const Vec3f> seen = cells_.answer(look_ups_, seed);
  for (const LookUps::Link& link : look_ups_.links()) {
    Vec3f& colour = tile_.knots[link.knot].colour;
    colour = cells_.limited(colour + seen[link.query]);
  }
  left_ = left;
  top_ = top;
}

void CellTileWorker::add_counts(RenderStats& stats) const {
  worker_->add_counts(stats);
  stats.shading_samples += cells_.evaluations();
}

}  // namespace kairos
