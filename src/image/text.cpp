#include "image/text.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <stb/stb_easy_font.h>

namespace kairos {
namespace {

constexpr int kLineDots = 12;               // the font's line height
constexpr int kMarginDots = 3;              // around the text
constexpr size_t kBytesPerCharacter = 600;  // the font's widest glyphs take fewer than 300

struct Quad {
  struct Vertex {
    float x, y, z;
    unsigned char color[4];
  } corners[4];
};

/// Replaces each value in the rectangle [x0, x1) x [y0, y1), cut to the picture, by scale * value + offset.
void tint(Image& image, int x0, int y0, int x1, int y1, float scale, float offset) {
  x0 = std::clamp(x0, 0, image.width);
  x1 = std::clamp(x1, 0, image.width);
  y0 = std::clamp(y0, 0, image.height);
  y1 = std::clamp(y1, 0, image.height);
  for (Channel& channel : image.channels)
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        float& value =
            channel.values[static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)];
        value = scale * value + offset;
      }
}

}  // namespace

int text_height(int scale) { return (kLineDots + kMarginDots) * scale; }

void draw_text(Image& image, int x, int y, int scale, const std::string& text) {
  std::string line = text;
  for (char& c : line)
    if (c < ' ' || c > '~') c = '?';
  std::vector<Quad> quads(line.size() * kBytesPerCharacter / sizeof(Quad) + 1);
  const int count =
      stb_easy_font_print(0, 0, line.data(), nullptr, quads.data(), static_cast<int>(quads.size() * sizeof(Quad)));
  const int width = stb_easy_font_width(line.data());
  tint(image, x, y, x + (width + 2 * kMarginDots) * scale, y + text_height(scale), 0.2f, 0);
  for (int i = 0; i < count; ++i) {
    const Quad& quad = quads[static_cast<size_t>(i)];
    const auto dots = [&](float position, int origin) {
      return origin + (static_cast<int>(std::lround(position)) + kMarginDots) * scale;
    };
    tint(image, dots(quad.corners[0].x, x), dots(quad.corners[0].y, y), dots(quad.corners[2].x, x),
         dots(quad.corners[2].y, y), 0, 1);
  }
}

}  // namespace kairos
