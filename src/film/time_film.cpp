#include <kairos/error.h>

#include "film/time_tiles.h"

namespace kairos {

namespace {

class MemoryTiles : public TimeTiles {
 public:
  MemoryTiles(TileGrid grid, double tolerance) : tiles_(grid.count()) {
    quality_.tolerance = tolerance;
    quality_.missing = static_cast<uint64_t>(grid.width) * static_cast<uint64_t>(grid.height);
  }

  std::shared_ptr<const TimeTile> tile(size_t number) override { return tiles_[number]; }
  TimeQuality quality() override { return quality_; }

  void put(size_t number, TimeTile tile) {
    const std::lock_guard<std::mutex> lock(mutex_);
    add_to(quality_, tile);
    tiles_[number] = std::make_shared<const TimeTile>(std::move(tile));
  }

 private:
  std::mutex mutex_;  // of `quality_`
  TimeQuality quality_;
  std::vector<std::shared_ptr<const TimeTile>> tiles_;
};

}  // namespace

class TimeFilm::Tiles {
 public:
  Tiles(TileGrid grid, int left, int top, double tolerance)
      : maker(grid, left, top, tolerance), tiles(std::make_shared<MemoryTiles>(grid, tolerance)) {}

  TileMaker maker;
  std::shared_ptr<MemoryTiles> tiles;
};

TimeFilm::TimeFilm(const Shot& shot, const RenderParams& params, double tolerance, FrameClock clock)
    : needs_(time_needs(params)), frame_(time_frame(shot, params, clock)) {
  check_tolerance(tolerance);
  tiles_ = std::make_unique<Tiles>(TileGrid{frame_.width, frame_.height}, frame_.left, frame_.top, tolerance);
}
TimeFilm::~TimeFilm() = default;

RecordNeeds TimeFilm::needs() const { return needs_; }

void TimeFilm::add(const PixelRecord& record) {
  size_t number = 0;
  if (auto tile = tiles_->maker.add(record, number)) tiles_->tiles->put(number, std::move(*tile));
}

TimePicture TimeFilm::take() {
  const TileMaker& maker = tiles_->maker;
  auto fresh = std::make_unique<Tiles>(maker.grid(), frame_.left, frame_.top, maker.tolerance());
  std::swap(tiles_, fresh);
  return {frame_, std::move(fresh->tiles)};
}

}  // namespace kairos
