// What each mesh contributes to an exposure.
#include <limits>

#include "film/tile_reading.h"

namespace kairos {

namespace {

/// The nearest value of a function, at the ends of its pieces and of the stretch, over [begin, end].
float nearest_of(const DepthPieces& depth, size_t function, double begin, double end) {
  const size_t last = depth.first[function + 1];
  float least = std::numeric_limits<float>::infinity();
  for (size_t piece = piece_at(depth.begin, depth.first[function], last, begin);
       piece < last && (depth.begin[piece] * kTick < end || begin == end); ++piece) {
    const double from = depth.begin[piece] * kTick, to = end_of(depth.begin, piece, last);
    if (from > end) break;
    const auto left = static_cast<double>(depth.left[piece]), right = static_cast<double>(depth.right[piece]);
    if (left == std::numeric_limits<double>::infinity()) continue;
    const auto at = [&](double time) { return left + (right - left) * ((time - from) / (to - from)); };
    least = std::min({least, static_cast<float>(at(std::max(from, begin))), static_cast<float>(at(std::min(to, end)))});
  }
  return least;
}

/// A weight, and when it is not zero.
struct ObjectScan {
  explicit ObjectScan(const TimeWeight& weight)
      : scan(weight), begin(weight.points().front().time), end(weight.points().back().time) {}

  WeightScan scan;
  double begin, end;
};

/// make_object(crop) gives when a tile matters, and a function of (tile, number of the object in it, x, y) that returns
/// the object's value and its depth.
template <class MakeObject>
ExposedObjects find_objects(const TimeFrame& frame, TimeTiles& tiles, const ExposeOptions& options,
                            const MakeObject& make_object) {
  if (!tiles.has_objects())
    throw Error(ErrorCode::bad_usage, "", "what each mesh contributes is not kept in this picture over time");
  const TileGrid grid{frame.width, frame.height};
  std::vector<ExposedObjects> of_tiles(grid.count());
  over_tiles(grid, options, [&](size_t number) {
    const Crop crop = grid.pixels(number);
    const auto [when, object] = make_object(crop);
    const auto tile = tiles.objects(number, when);
    if (tile == nullptr) return;
    ExposedObjects& out = of_tiles[number];
    out.first.push_back(0);
    for (size_t pixel = 0; pixel < tile->pixels(); ++pixel) {
      const int across = crop.x1 - crop.x0, x = crop.x0 + static_cast<int>(pixel) % across,
                y = crop.y0 + static_cast<int>(pixel) / across;
      for (size_t i = tile->first[pixel]; i < tile->first[pixel + 1]; ++i) {
        const auto [value, depth] = object(*tile, i, x, y);
        if (depth < std::numeric_limits<float>::infinity())
          out.seen.push_back({tile->mesh[i], {value[0], value[1], value[2]}, value[3], depth});
      }
      out.first.push_back(out.seen.size());
    }
  });
  ExposedObjects all;
  all.first.push_back(0);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const ExposedObjects& tile = of_tiles[grid.tile_of(x, y)];
      if (!tile.first.empty()) {
        const auto seen = tile.of(grid.index(x, y));
        all.seen.insert(all.seen.end(), seen.begin(), seen.end());
      }
      all.first.push_back(all.seen.size());
    }
  return all;
}

}  // namespace

bool TimePicture::has_objects() const { return tiles_->has_objects(); }

ExposedObjects TimePicture::objects(const PixelWeights& weights, const ExposeOptions& options) const {
  return find_objects(frame_, *tiles_, options, [&](const Crop& crop) {
    ScansOfTile<ObjectScan> scans(weights, frame_, crop);
    const TimeStretch when = scans.when();
    return std::pair(when, [of_tile = std::move(scans)](const ObjectTile& tile, size_t i, int x, int y) {
      const ObjectScan& weight = of_tile.at(x, y);
      return std::pair(weight.scan.integral(tile.signals, tile.signals.first[i], tile.signals.first[i + 1]),
                       nearest_of(tile.depth, i, weight.begin, weight.end));
    });
  });
}

ExposedObjects TimePicture::objects_at(double time, const ExposeOptions& options) const {
  check_shutter_time(time);
  return find_objects(frame_, *tiles_, options, [&](const Crop&) {
    return std::pair(TimeStretch{time, time}, [time](const ObjectTile& tile, size_t i, int, int) {
      return std::pair(value_at_time(tile.signals, i, time), nearest_of(tile.depth, i, time, time));
    });
  });
}

}  // namespace kairos
