// What exposures ask of tiles: values, weights, and a loop over all of them.
#pragma once

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include <kairos/error.h>
#include <kairos/time_picture.h>

#include "base/parallel.h"
#include "film/lanes.h"
#include "film/time_tiles.h"
#include "film/weight_scan.h"

namespace kairos {

/// The value of a piece, `place` of the way from its beginning to its end.
template <class Number>
Lanes value_at(const PieceValues<Number>& values, size_t piece, double place) {
  return load_lanes(values.left[piece]) + load_lanes(values.step[piece]) * static_cast<float>(place);
}
inline Lanes value_at(const TimeTile& tile, size_t piece, double place) {
  return tile.exact() ? value_at(tile.floats, piece, place) : value_at(tile.halves, piece, place);
}

/// Of a function's pieces that begin at these ticks, [first, last): the one at a shutter time.
inline size_t piece_at(const std::vector<uint32_t>& begin, size_t first, size_t last, double time) {
  const auto from = begin.begin() + static_cast<std::ptrdiff_t>(first),
             to = begin.begin() + static_cast<std::ptrdiff_t>(last);
  const auto after = std::upper_bound(from + 1, to, time, [](double t, uint32_t tick) { return t < tick * kTick; });
  return static_cast<size_t>(after - begin.begin()) - 1;
}
/// When a piece ends, where those of its function end before `last`.
inline double end_of(const std::vector<uint32_t>& begin, size_t piece, size_t last) {
  return piece + 1 < last ? begin[piece + 1] * kTick : 1.0;
}

/// A pixel's value at a shutter time.
inline Lanes value_at_time(const TimeTile& tile, size_t pixel, double time) {
  const size_t last = tile.first[pixel + 1], piece = piece_at(tile.begin, tile.first[pixel], last, time);
  const double begin = tile.begin[piece] * kTick, end = end_of(tile.begin, piece, last);
  return value_at(tile, piece, (time - begin) / (end - begin));
}

inline void check_shutter_time(double time) {
  if (!(time >= 0 && time <= 1)) throw Error(ErrorCode::bad_usage, "", "a shutter time must be 0 to 1");
}

/// Each weight that there is in a tile, once.
template <class Scan>
class ScansOfTile {
 public:
  /// crop: the tile's pixels, in the picture.
  ScansOfTile(const PixelWeights& weights, const TimeFrame& frame, const Crop& crop)
      : crop_(crop),
        across_(weights.varies_in_x ? crop.x1 - crop.x0 : 1),
        varies_in_x_(weights.varies_in_x),
        varies_in_y_(weights.varies_in_y) {
    const int down = varies_in_y_ ? crop.y1 - crop.y0 : 1;
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across_; ++x) {
        const TimeWeight weight = weights.at(frame.left + crop.x0 + x, frame.top + crop.y0 + y);
        const auto points = weight.points();
        when_ = {std::min(when_.begin, points.front().time), std::max(when_.end, points.back().time)};
        scans_.emplace_back(weight);
      }
  }

  /// Outside of which all of them are zero.
  const TimeStretch& when() const { return when_; }

  /// x, y: in the picture.
  const Scan& at(int x, int y) const {
    const int column = varies_in_x_ ? x - crop_.x0 : 0, row = varies_in_y_ ? y - crop_.y0 : 0;
    return scans_[static_cast<size_t>(row * across_ + column)];
  }

 private:
  Crop crop_;
  int across_;
  bool varies_in_x_, varies_in_y_;
  std::vector<Scan> scans_;
  TimeStretch when_{1, 0};
};
using TileScans = ScansOfTile<WeightScan>;

/// Calls do_tile(number) for every tile, from many threads. Throws Error(cancelled) when progress says so.
template <class DoTile>
void over_tiles(const TileGrid& grid, const ExposeOptions& options, const DoTile& do_tile) {
  std::atomic<size_t> done{0};
  const auto work = [&] {
    parallel_for(grid.count(), 1, [&](size_t begin, size_t end) {
      for (size_t number = begin; number < end; ++number) {
        do_tile(number);
        done.fetch_add(1, std::memory_order_relaxed);
      }
    });
  };
  if (options.progress) {
    with_threads(options.threads, work,
                 [&] { return options.progress(static_cast<double>(done) / static_cast<double>(grid.count())); });
    if (!options.progress(1)) throw Error(ErrorCode::cancelled, "", "exposing was stopped");
  } else {
    with_threads(options.threads, work);
  }
}

}  // namespace kairos
