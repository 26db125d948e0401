#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <kairos/compare.h>
#include <kairos/error.h>

#include "image/text.h"

namespace kairos {
namespace {

constexpr int kGap = 8;                  // pixels between panels
constexpr int64_t kLargestSide = 32768;  // pixels; what common viewers still open

using Colours = std::array<const std::vector<float>*, 3>;

size_t pixel_index(const Image& image, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
}

Colours colours_of(const Image& image, const std::string& place) {
  Colours colours{};
  const std::array<const char*, 3> names{"R", "G", "B"};
  for (size_t i = 0; i < 3; ++i) {
    const Channel* channel = image.find(names[i]);
    if (!channel) throw Error(ErrorCode::bad_input, place, fmt::format("has no channel {}", names[i]));
    colours[i] = &channel->values;
  }
  return colours;
}

void check_size(const Image& image, int width, int height, const std::string& place) {
  if (image.width != width || image.height != height)
    throw Error(ErrorCode::bad_input, place,
                fmt::format("is {}x{} pixels where {}x{} are expected; compare pictures of one size", image.width,
                            image.height, width, height));
}

/// Copies the pixels `from` of one picture to (left, top) in another, each as a square of `factor` pixels.
void paste(const Colours& source, const Image& source_image, const PixelBox& from, int factor, Image& target, int left,
           int top) {
  for (size_t c = 0; c < 3; ++c)
    for (int y = 0; y < from.height * factor; ++y)
      for (int x = 0; x < from.width * factor; ++x)
        target.channels[c].values[pixel_index(target, left + x, top + y)] =
            (*source[c])[pixel_index(source_image, from.x + x / factor, from.y + y / factor)];
}

/// A white line, one pixel wide, around [x, x + width) x [y, y + height); what lies outside the picture is cut.
void outline(Image& image, int left, int top, const PixelBox& box) {
  for (Channel& channel : image.channels)
    for (int y = std::max(box.y - 1, 0); y <= std::min(box.y + box.height, image.height - 1 - top); ++y)
      for (int x = std::max(box.x - 1, 0); x <= std::min(box.x + box.width, image.width - 1 - left); ++x)
        if (x < box.x || y < box.y || x == box.x + box.width || y == box.y + box.height)
          channel.values[pixel_index(image, left + x, top + y)] = 1;
}

}  // namespace

Difference difference(const Image& reference, const Image& image, const std::string& place) {
  check_size(image, reference.width, reference.height, place);
  const Colours expected = colours_of(reference, "the reference"), got = colours_of(image, place);
  double sum = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < got[c]->size(); ++i) {
      const double delta = static_cast<double>((*got[c])[i]) - static_cast<double>((*expected[c])[i]);
      if (!std::isfinite(delta)) {
        const size_t width = static_cast<size_t>(image.width);
        throw Error(ErrorCode::bad_input, place,
                    fmt::format("pixel ({}, {}), or the reference's, is not a finite number", i % width, i / width));
      }
      sum += delta * delta;
    }
  Difference result;
  result.mse = sum / (3.0 * static_cast<double>(got[0]->size()));
  result.psnr = result.mse > 0 ? -10 * std::log10(result.mse) : std::numeric_limits<double>::infinity();
  return result;
}

Image side_by_side(std::span<const Panel> panels, const std::optional<PixelBox>& zoom) {
  if (panels.empty()) throw Error(ErrorCode::bad_usage, "", "there is no picture to show");
  const int width = panels[0].image->width, height = panels[0].image->height;
  int factor = 0;
  if (zoom) {
    const bool inside = zoom->x >= 0 && zoom->y >= 0 && zoom->width > 0 && zoom->height > 0 && zoom->width <= width &&
                        zoom->height <= height && zoom->x <= width - zoom->width && zoom->y <= height - zoom->height;
    if (!inside)
      throw Error(ErrorCode::bad_usage, "",
                  fmt::format("the magnified part {},{},{},{} (x, y, width, height) is not inside {}x{} pixels",
                              zoom->x, zoom->y, zoom->width, zoom->height, width, height));
    factor = width / zoom->width;
  }
  const int64_t total_width = static_cast<int64_t>(panels.size()) * (int64_t{width} + kGap) - kGap;
  const int64_t total_height = height + (zoom ? kGap + int64_t{zoom->height} * factor : 0);
  if (total_width > kLargestSide || total_height > kLargestSide)
    throw Error(ErrorCode::bad_usage, "",
                fmt::format("the side-by-side would be {}x{} pixels; compare fewer pictures, or a wider part of them",
                            total_width, total_height));
  const int count = static_cast<int>(panels.size());
  Image result;
  result.width = result.frame_width = static_cast<int>(total_width);
  result.height = result.frame_height = static_cast<int>(total_height);
  const size_t pixels = static_cast<size_t>(total_width) * static_cast<size_t>(total_height);
  for (const char* name : {"R", "G", "B"})
    result.channels.push_back({name, Channel::Storage::colour, std::vector<float>(pixels, 0.0f)});

  const int text_scale = std::max(1, width / 400);
  for (int i = 0; i < count; ++i) {
    const Panel& panel = panels[static_cast<size_t>(i)];
    const int left = i * (width + kGap);
    check_size(*panel.image, width, height, panel.label);
    const Colours colours = colours_of(*panel.image, panel.label);
    paste(colours, *panel.image, {0, 0, width, height}, 1, result, left, 0);
    if (zoom) {
      outline(result, left, 0, *zoom);
      paste(colours, *panel.image, *zoom, factor, result, left, height + kGap);
    }
    if (!panel.label.empty()) draw_text(result, left, height - text_height(text_scale), text_scale, panel.label);
  }
  return result;
}

}  // namespace kairos
