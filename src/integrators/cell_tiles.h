// Pixels whose light is shared through cells of surfaces: rendered square by square.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "film/record_tile.h"
#include "integrators/integrator.h"
#include "shading/look_ups.h"
#include "shading/surface_cells.h"

namespace kairos {

/// How, for a shot and parameters.
struct CellPlan {
  int side = 0;  ///< of the squares of pixels, aligned to the frame, within which light is shared; 0: nowhere
  int frame_width = 0, frame_height = 0;
  CellOptions cells;
  uint64_t seed = 0;
};
/// cells: see choose_cells(). look_ups: per pixel, about.
CellPlan plan_cells(const Shot& shot, const RenderParams& params, const std::optional<CellOptions>& cells,
                    double look_ups);

/// A worker that hands what it would shade to `look_ups`; null: shades it itself.
using MakeWorker = std::function<std::unique_ptr<Integrator::Worker>(LookUps* look_ups)>;
/// Of an integrator that shares light by such a plan, or does not.
std::unique_ptr<Integrator::Worker> make_cell_worker(const CellPlan& plan, const PixelContext& context,
                                                     const MakeWorker& make_worker);

/// Renders the whole square in which a pixel lies when the first of its pixels is asked for, so that a pixel is the
/// same in any crop. Holds its records, of some 25 MB for a side of 64 pixels.
class CellTileWorker : public Integrator::Worker {
 public:
  CellTileWorker(const CellPlan& plan, const PixelContext& context, const MakeWorker& make_worker);

  const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override;
  void add_counts(RenderStats& stats) const override;

 private:
  void render_tile(int left, int top, Monitor& monitor);

  CellPlan plan_;
  bool keep_surfaces_;
  LookUps look_ups_;
  std::unique_ptr<Worker> worker_;
  SurfaceCells cells_;
  RecordTile tile_;
  int left_ = -1, top_ = -1, right_ = -1;  // of the tile
  PixelRecord record_;
};

}  // namespace kairos
