#include <algorithm>

#include <kairos/error.h>
#include <kairos/time_picture.h>

#include "film/frame_image.h"
#include "film/tile_reading.h"

namespace kairos {

namespace {

Image empty_image(const TimeFrame& frame, bool coverage) {
  Image image = frame_image(frame);
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  for (const char* name : {"R", "G", "B"})
    image.channels.push_back({name, Channel::Storage::colour, std::vector<float>(pixels)});
  if (frame.alpha) image.channels.push_back({"A", Channel::Storage::colour, std::vector<float>(pixels)});
  if (coverage) image.channels.push_back({"coverage.A", Channel::Storage::colour, std::vector<float>(pixels)});
  return image;
}

/// Calls pixel(tile, number of the pixel in it, x, y) for every pixel of the picture that is there, tile by tile, and
/// puts the four values that it returns into an image. make_pixel(crop) gives when a tile matters, and that function.
template <class MakePixel>
Image develop(const TimeFrame& frame, TimeTiles& tiles, const ExposeOptions& options, const MakePixel& make_pixel) {
  Image image = empty_image(frame, options.coverage);
  const TileGrid grid{frame.width, frame.height};
  over_tiles(grid, options, [&](size_t number) {
    const Crop crop = grid.pixels(number);
    const auto [when, pixel] = make_pixel(crop);
    const auto tile = tiles.tile(number, when);
    if (tile == nullptr) return;
    size_t i = 0;
    for (int y = crop.y0; y < crop.y1; ++y)
      for (int x = crop.x0; x < crop.x1; ++x, ++i) {
        const Lanes value = pixel(*tile, i, x, y);
        const size_t at = static_cast<size_t>(y) * static_cast<size_t>(frame.width) + static_cast<size_t>(x);
        for (size_t c = 0; c < image.channels.size(); ++c) image.channels[c].values[at] = value[std::min<size_t>(c, 3)];
      }
  });
  return image;
}

}  // namespace

PixelWeights pixel_weights(const Exposure& exposure) {
  const Shutter& shutter = exposure.shutter();
  const bool rows = shutter.scan == Scan::top || shutter.scan == Scan::bottom;
  const bool rolls = shutter.open_line != 0 || shutter.close_line != 0;
  return {[exposure](int x, int y) { return exposure.weight(x, y); }, shutter.map != nullptr || (rolls && !rows),
          shutter.map != nullptr || (rolls && rows)};
}

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
    TileScans scans(weights, frame_, crop);
    const TimeStretch when = scans.when();
    return std::pair(when, [of_tile = std::move(scans)](const TimeTile& tile, size_t i, int x, int y) {
      return of_tile.at(x, y).integral(tile, tile.first[i], tile.first[i + 1]);
    });
  });
}

Image TimePicture::expose(const TimeWeight& weight, const ExposeOptions& options) const {
  return expose(PixelWeights{[&](int, int) { return weight; }}, options);
}

Image TimePicture::at(double time, const ExposeOptions& options) const {
  check_shutter_time(time);
  return develop(frame_, *tiles_, options, [&](const Crop&) {
    return std::pair(TimeStretch{time, time},
                     [time](const TimeTile& tile, size_t i, int, int) { return value_at_time(tile, i, time); });
  });
}

std::vector<TimePiece> TimePicture::signal(int x, int y) const {
  const int column = x - frame_.left, row = y - frame_.top;
  if (column < 0 || row < 0 || column >= frame_.width || row >= frame_.height)
    throw Error(ErrorCode::bad_usage, "", "pixel " + std::to_string(x) + "," + std::to_string(y) + " is not held");
  const TileGrid grid{frame_.width, frame_.height};
  std::vector<TimePiece> pieces;
  const auto tile = tiles_->tile(grid.tile_of(column, row), {});
  if (tile == nullptr) return pieces;
  const size_t pixel = grid.index(column, row);
  for (size_t i = tile->first[pixel]; i < tile->first[pixel + 1]; ++i) {
    const Lanes left = value_at(*tile, i, 0), right = value_at(*tile, i, 1);
    TimePiece& piece = pieces.emplace_back();
    piece.begin = tile->begin[i] * kTick;
    piece.end = end_of(tile->begin, i, tile->first[pixel + 1]);
    for (size_t c = 0; c < 4; ++c) {
      piece.left[c] = left[c];
      piece.right[c] = right[c];
    }
  }
  return pieces;
}

}  // namespace kairos
