// Where the tiles of a picture over time come from, and how they are made.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <kairos/time_picture.h>

#include "film/object_coder.h"
#include "film/object_tile.h"
#include "film/record_tile.h"
#include "film/time_coder.h"
#include "film/time_signal.h"
#include "film/time_tile.h"

namespace kairos {

/// Pixels: the side of a tile. Those at the right and lower edge are smaller where it must be.
inline constexpr int kTimeTileSide = 32;

/// Which pixels lie in which tile of a picture of width x height pixels, in rows from the top.
struct TileGrid {
  int width = 0, height = 0;

  int columns() const { return (width + kTimeTileSide - 1) / kTimeTileSide; }
  int rows() const { return (height + kTimeTileSide - 1) / kTimeTileSide; }
  size_t count() const { return static_cast<size_t>(columns()) * static_cast<size_t>(rows()); }
  size_t tile_of(int x, int y) const {
    return static_cast<size_t>(y / kTimeTileSide) * static_cast<size_t>(columns()) +
           static_cast<size_t>(x / kTimeTileSide);
  }
  /// In the picture.
  Crop pixels(size_t tile) const {
    const int left = static_cast<int>(tile % static_cast<size_t>(columns())) * kTimeTileSide;
    const int top = static_cast<int>(tile / static_cast<size_t>(columns())) * kTimeTileSide;
    return {left, std::min(left + kTimeTileSide, width), top, std::min(top + kTimeTileSide, height)};
  }
  size_t pixel_count(size_t tile) const {
    const Crop crop = pixels(tile);
    return static_cast<size_t>(crop.x1 - crop.x0) * static_cast<size_t>(crop.y1 - crop.y0);
  }
  /// Number of a pixel of the picture within its tile.
  size_t index(int x, int y) const {
    const Crop crop = pixels(tile_of(x, y));
    return static_cast<size_t>(y - crop.y0) * static_cast<size_t>(crop.x1 - crop.x0) + static_cast<size_t>(x - crop.x0);
  }
};

/// Of the picture's time, 0 to 1.
struct TimeStretch {
  double begin = 0, end = 1;
};

/// Hands out tiles, from any thread.
class TimeTiles {
 public:
  virtual ~TimeTiles() = default;
  /// Null where none of its pixels was rendered. What it shows outside of the stretch may be left out, as black.
  virtual std::shared_ptr<const TimeTile> tile(size_t number, const TimeStretch& when) = 0;
  /// Null also where meshes are not kept.
  virtual std::shared_ptr<const ObjectTile> objects(size_t number, const TimeStretch& when) = 0;
  virtual bool has_objects() const = 0;
  virtual TimeQuality quality() = 0;
};

/// All that is kept of a square of pixels.
struct WholeTile {
  TimeTile signals;
  ObjectTile objects;  ///< empty where meshes are not kept
  RecordTile records;  ///< empty where rays are not kept
};

/// Makes tiles of records, which come in any order and from any thread.
class TileMaker {
 public:
  TileMaker(TileGrid grid, int left, int top, double tolerance, bool objects, bool rays = false);
  ~TileMaker();

  const TileGrid& grid() const { return grid_; }
  double tolerance() const { return tolerance_; }
  bool keeps_objects() const { return objects_; }

  /// The record's tile, if this was its last pixel, else none. `number`: set to the tile's in any case.
  std::optional<WholeTile> add(const PixelRecord& record, size_t& number);

 private:
  struct Open;
  struct Workspace;

  TileGrid grid_;
  int left_, top_;  // of the picture in the frame
  double tolerance_;
  bool objects_, rays_;
  std::mutex mutex_;                         // of what follows, not of what it points to
  std::vector<std::unique_ptr<Open>> open_;  // [tile]
  std::vector<std::unique_ptr<Workspace>> idle_;
};

/// Counts a tile that is there.
void add_to(TimeQuality& quality, const TimeTile& tile);

/// Of what is rendered. Throws Error(bad_usage): see TimeFilm.
TimeFrame time_frame(const Shot& shot, const RenderParams& params, const FrameClock& clock, bool objects);
/// Throws Error(bad_usage) for one that makes no sense.
void check_tolerance(double tolerance);
/// What a consumer that keeps time needs of records: where what moves throws light and shadow on what does not, time
/// everywhere.
RecordNeeds time_needs(const RenderParams& params);

}  // namespace kairos
