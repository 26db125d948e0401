#include <algorithm>
#include <atomic>
#include <cmath>

#include <kairos/error.h>
#include <kairos/time_picture.h>

#include "base/parallel.h"
#include "film/half.h"
#include "film/time_tiles.h"
#include "film/weight_scan.h"

namespace kairos {

namespace {

/// The value of a piece, `place` of the way from its beginning to its end.
template <class Number>
Lanes value_at(const PieceValues<Number>& values, size_t piece, double place) {
  return load_lanes(values.left[piece]) + load_lanes(values.step[piece]) * static_cast<float>(place);
}

Lanes value_at(const TimeTile& tile, size_t piece, double place) {
  return tile.exact() ? value_at(tile.floats, piece, place) : value_at(tile.halves, piece, place);
}

double end_of(const TimeTile& tile, size_t piece, size_t last) {
  return piece + 1 < last ? tile.begin[piece + 1] * kTick : 1.0;
}

Image empty_image(const TimeFrame& frame, bool coverage) {
  Image image;
  image.width = frame.width;
  image.height = frame.height;
  image.left = frame.left;
  image.top = frame.top;
  image.frame_width = frame.frame_width;
  image.frame_height = frame.frame_height;
  image.pixel_aspect = frame.pixel_aspect;
  image.attributes = frame.attributes;
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  for (const char* name : {"R", "G", "B"})
    image.channels.push_back({name, Channel::Storage::colour, std::vector<float>(pixels)});
  if (frame.alpha) image.channels.push_back({"A", Channel::Storage::colour, std::vector<float>(pixels)});
  if (coverage) image.channels.push_back({"coverage.A", Channel::Storage::colour, std::vector<float>(pixels)});
  return image;
}

/// Calls pixel(tile, number of the pixel in it, x, y) for every pixel of the picture that is there, tile by tile, and
/// puts the four values that it returns into an image.
template <class MakePixel>
Image develop(const TimeFrame& frame, TimeTiles& tiles, const ExposeOptions& options, const MakePixel& make_pixel) {
  Image image = empty_image(frame, options.coverage);
  const TileGrid grid{frame.width, frame.height};
  std::atomic<size_t> done{0};
  const auto work = [&] {
    parallel_for(grid.count(), 1, [&](size_t begin, size_t end) {
      for (size_t number = begin; number < end; ++number) {
        const Crop crop = grid.pixels(number);
        if (const auto tile = tiles.tile(number)) {
          auto pixel = make_pixel(crop);
          size_t i = 0;
          for (int y = crop.y0; y < crop.y1; ++y)
            for (int x = crop.x0; x < crop.x1; ++x, ++i) {
              const Lanes value = pixel(*tile, i, x, y);
              const size_t at = static_cast<size_t>(y) * static_cast<size_t>(frame.width) + static_cast<size_t>(x);
              for (size_t c = 0; c < image.channels.size(); ++c)
                image.channels[c].values[at] = value[std::min<size_t>(c, 3)];
            }
        }
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
  return image;
}

}  // namespace

TimePicture::TimePicture(TimeFrame frame, std::shared_ptr<TimeTiles> tiles)
    : frame_(std::move(frame)), tiles_(std::move(tiles)) {}
TimePicture::~TimePicture() = default;
TimePicture::TimePicture(const TimePicture&) = default;
TimePicture::TimePicture(TimePicture&&) noexcept = default;
TimePicture& TimePicture::operator=(const TimePicture&) = default;
TimePicture& TimePicture::operator=(TimePicture&&) noexcept = default;

const TimeFrame& TimePicture::frame() const { return frame_; }
TimeQuality TimePicture::quality() const { return tiles_->quality(); }

Image TimePicture::expose(const PixelWeights& weights, const ExposeOptions& options) const {
  return develop(frame_, *tiles_, options, [&](const Crop& crop) {
    // Each weight that there is in the tile, once.
    std::vector<WeightScan> scans;
    const int across = weights.varies_in_x ? crop.x1 - crop.x0 : 1, down = weights.varies_in_y ? crop.y1 - crop.y0 : 1;
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across; ++x)
        scans.emplace_back(weights.at(frame_.left + crop.x0 + x, frame_.top + crop.y0 + y));
    return [&weights, crop, across, scans = std::move(scans)](const TimeTile& tile, size_t i, int x, int y) {
      const int column = weights.varies_in_x ? x - crop.x0 : 0, row = weights.varies_in_y ? y - crop.y0 : 0;
      return scans[static_cast<size_t>(row * across + column)].integral(tile, tile.first[i], tile.first[i + 1]);
    };
  });
}

Image TimePicture::expose(const TimeWeight& weight, const ExposeOptions& options) const {
  return expose(PixelWeights{[&](int, int) { return weight; }}, options);
}

Image TimePicture::at(double time, const ExposeOptions& options) const {
  if (!(time >= 0 && time <= 1)) throw Error(ErrorCode::bad_usage, "", "a shutter time must be 0 to 1");
  return develop(frame_, *tiles_, options, [&](const Crop&) {
    return [time](const TimeTile& tile, size_t i, int, int) {
      const auto first = tile.begin.begin() + tile.first[i], last = tile.begin.begin() + tile.first[i + 1];
      const auto after =
          std::upper_bound(first + 1, last, time, [](double t, uint32_t tick) { return t < tick * kTick; });
      const auto piece = static_cast<size_t>(after - tile.begin.begin()) - 1;
      const double begin = tile.begin[piece] * kTick, end = end_of(tile, piece, tile.first[i + 1]);
      return value_at(tile, piece, (time - begin) / (end - begin));
    };
  });
}

std::vector<TimePiece> TimePicture::signal(int x, int y) const {
  const int column = x - frame_.left, row = y - frame_.top;
  if (column < 0 || row < 0 || column >= frame_.width || row >= frame_.height)
    throw Error(ErrorCode::bad_usage, "", "pixel " + std::to_string(x) + "," + std::to_string(y) + " is not held");
  const TileGrid grid{frame_.width, frame_.height};
  std::vector<TimePiece> pieces;
  const auto tile = tiles_->tile(grid.tile_of(column, row));
  if (tile == nullptr) return pieces;
  const size_t pixel = grid.index(column, row);
  for (size_t i = tile->first[pixel]; i < tile->first[pixel + 1]; ++i) {
    const Lanes left = value_at(*tile, i, 0), right = value_at(*tile, i, 1);
    TimePiece& piece = pieces.emplace_back();
    piece.begin = tile->begin[i] * kTick;
    piece.end = end_of(*tile, i, tile->first[pixel + 1]);
    for (size_t c = 0; c < 4; ++c) {
      piece.left[c] = left[c];
      piece.right[c] = right[c];
    }
  }
  return pieces;
}

}  // namespace kairos
