#include <kairos/error.h>

#include "film/time_tiles.h"

namespace kairos {

namespace {

class MemoryTiles : public TimeTiles {
 public:
  MemoryTiles(TileGrid grid, double tolerance, bool objects)
      : has_objects_(objects), tiles_(grid.count()), objects_(grid.count()) {
    quality_.tolerance = tolerance;
    quality_.missing = static_cast<uint64_t>(grid.width) * static_cast<uint64_t>(grid.height);
  }

  std::shared_ptr<const TimeTile> tile(size_t number, const TimeStretch&) override { return tiles_[number]; }
  std::shared_ptr<const ObjectTile> objects(size_t number, const TimeStretch&) override { return objects_[number]; }
  bool has_objects() const override { return has_objects_; }
  TimeQuality quality() override { return quality_; }

  void put(size_t number, WholeTile tile) {
    const std::lock_guard<std::mutex> lock(mutex_);
    add_to(quality_, tile.signals);
    tiles_[number] = std::make_shared<const TimeTile>(std::move(tile.signals));
    if (has_objects_) objects_[number] = std::make_shared<const ObjectTile>(std::move(tile.objects));
  }

 private:
  bool has_objects_;
  std::mutex mutex_;  // of `quality_`
  TimeQuality quality_;
  std::vector<std::shared_ptr<const TimeTile>> tiles_;
  std::vector<std::shared_ptr<const ObjectTile>> objects_;
};

}  // namespace

class TimeFilm::Tiles {
 public:
  Tiles(TileGrid grid, int left, int top, double tolerance, bool objects)
      : maker(grid, left, top, tolerance, objects), tiles(std::make_shared<MemoryTiles>(grid, tolerance, objects)) {}

  TileMaker maker;
  std::shared_ptr<MemoryTiles> tiles;
};

TimeFilm::TimeFilm(const Shot& shot, const RenderParams& params, double tolerance, FrameClock clock, bool objects)
    : needs_(time_needs(params)), frame_(time_frame(shot, params, clock, objects)) {
  check_tolerance(tolerance);
  tiles_ = std::make_unique<Tiles>(TileGrid{frame_.width, frame_.height}, frame_.left, frame_.top, tolerance, objects);
}
TimeFilm::~TimeFilm() = default;

RecordNeeds TimeFilm::needs() const { return needs_; }

void TimeFilm::add(const PixelRecord& record) {
  size_t number = 0;
  if (auto tile = tiles_->maker.add(record, number)) tiles_->tiles->put(number, std::move(*tile));
}

TimePicture TimeFilm::take() {
  const TileMaker& maker = tiles_->maker;
  auto fresh = std::make_unique<Tiles>(maker.grid(), frame_.left, frame_.top, maker.tolerance(), maker.keeps_objects());
  std::swap(tiles_, fresh);
  return {frame_, std::move(fresh->tiles)};
}

}  // namespace kairos
