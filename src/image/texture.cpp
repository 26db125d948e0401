#include "image/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "image/srgb.h"

namespace kairos {

namespace {

constexpr size_t kTexelChannels = 4;
// Keeps the colour of a fully transparent texel from being 0 / 0, and from counting beside others.
constexpr float kLeastAlpha = 1e-4f;

/// The texel that stands for one just beyond an edge: the opposite one, or the edge itself.
int wrapped(int i, int size, TextureWrap wrap) {
  if (wrap != TextureWrap::repeat) return std::clamp(i, 0, size - 1);
  return i < 0 ? i + size : i >= size ? i - size : i;
}

/// The coordinate from 0 to 1 that is meant by v.
float inside(float v, TextureWrap wrap) {
  if (!std::isfinite(v)) return 0;
  switch (wrap) {
    case TextureWrap::repeat:
      break;
    case TextureWrap::clamp:
      return std::clamp(v, 0.0f, 1.0f);
    case TextureWrap::mirror: {
      const float turn = v - 2 * std::floor(v / 2);
      return turn > 1 ? 2 - turn : turn;
    }
  }
  return v - std::floor(v);
}

/// Which texels of a row of `from` a texel of a row of `to` covers, and how much of each: three at most.
struct Cover {
  int first = 0, count = 0;
  std::array<float, 3> weights{};

  Cover(int index, int to, int from) {
    const double scale = static_cast<double>(from) / to, begin = index * scale, end = (index + 1) * scale;
    first = static_cast<int>(begin);
    for (int i = first; i < from && i < end && count < 3; ++i)
      weights[static_cast<size_t>(count++)] =
          static_cast<float>(std::min<double>(end, i + 1) - std::max<double>(begin, i));
  }
};

/// Codes of 16 bits as values, which keep all of their bits.
Pixels widened(Pixels pixels, Texture::Encoding encoding) {
  if (pixels.wide_codes.empty()) return pixels;
  constexpr size_t kCodes = 1 << 16;
  std::vector<float> decoded(kCodes);
  for (size_t code = 0; code < kCodes; ++code) {
    const float value = static_cast<float>(code) / (kCodes - 1);
    decoded[code] = encoding == Texture::Encoding::srgb ? srgb_value(value) : value;
  }
  pixels.values.resize(pixels.wide_codes.size());
  for (size_t i = 0; i < pixels.values.size(); ++i) {
    const uint16_t code = pixels.wide_codes[i];
    pixels.values[i] = i % kTexelChannels == 3 ? static_cast<float>(code) / (kCodes - 1) : decoded[code];
  }
  pixels.wide_codes = {};
  return pixels;
}

}  // namespace

Texture::Texture(Pixels pixels, Encoding encoding) {
  pixels = widened(std::move(pixels), encoding);
  for (size_t code = 0; code < decoded_.size(); ++code) {
    const float value = static_cast<float>(code) / 255;
    decoded_[code] = encoding == Encoding::srgb ? srgb_value(value) : value;
  }
  for (size_t i = 3; i < pixels.codes.size() && !has_alpha_; i += kTexelChannels) has_alpha_ = pixels.codes[i] != 255;
  for (size_t i = 3; i < pixels.values.size() && !has_alpha_; i += kTexelChannels) has_alpha_ = pixels.values[i] < 1;
  levels_.push_back(std::move(pixels));
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half_of(levels_.back()));
}

Texel Texture::texel(const Pixels& level, int x, int y) const {
  const size_t i =
      (static_cast<size_t>(y) * static_cast<size_t>(level.width) + static_cast<size_t>(x)) * kTexelChannels;
  if (!level.codes.empty()) {
    const uint8_t* code = &level.codes[i];
    return {{decoded_[code[0]], decoded_[code[1]], decoded_[code[2]]}, static_cast<float>(code[3]) / 255};
  }
  const float* value = &level.values[i];
  return {{value[0], value[1], value[2]}, value[3]};
}

void Texture::store(Pixels& level, size_t index, const Texel& value) const {
  const size_t i = index * kTexelChannels;
  if (level.codes.empty()) {
    for (int c = 0; c < 3; ++c) level.values[i + static_cast<size_t>(c)] = value.colour[c];
    level.values[i + 3] = value.alpha;
    return;
  }
  for (int c = 0; c < 3; ++c) {
    const auto above = std::lower_bound(decoded_.begin() + 1, decoded_.end() - 1, value.colour[c]);
    const bool nearer_below = value.colour[c] - *(above - 1) < *above - value.colour[c];
    level.codes[i + static_cast<size_t>(c)] = static_cast<uint8_t>(above - decoded_.begin() - (nearer_below ? 1 : 0));
  }
  level.codes[i + 3] = static_cast<uint8_t>(std::lround(std::clamp(value.alpha, 0.0f, 1.0f) * 255));
}

Pixels Texture::half_of(const Pixels& level) const {
  Pixels half{std::max(1, level.width / 2), std::max(1, level.height / 2), {}, {}};
  const auto width = static_cast<size_t>(half.width), height = static_cast<size_t>(half.height);
  (level.codes.empty() ? half.values.resize(width * height * kTexelChannels)
                       : half.codes.resize(width * height * kTexelChannels));
  std::vector<Cover> columns;
  for (int x = 0; x < half.width; ++x) columns.emplace_back(x, half.width, level.width);
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const Cover rows(static_cast<int>(y), half.height, level.height);
      for (size_t x = 0; x < width; ++x) {
        Texel sum{{}, 0};
        float area = 0, colour_weight = 0;
        for (int j = 0; j < rows.count; ++j)
          for (int i = 0; i < columns[x].count; ++i) {
            const Texel one = texel(level, columns[x].first + i, rows.first + j);
            const float weight = rows.weights[static_cast<size_t>(j)] * columns[x].weights[static_cast<size_t>(i)];
            // What is transparent must not bleed its colour into what is seen.
            const float visible = has_alpha_ ? weight * std::max(one.alpha, kLeastAlpha) : weight;
            sum.colour += one.colour * visible;
            sum.alpha += one.alpha * weight;
            colour_weight += visible;
            area += weight;
          }
        store(half, y * width + x, {sum.colour / colour_weight, sum.alpha / area});
      }
    }
  });
  return half;
}

Texel Texture::containing(const Pixels& level, Vec2f uv, std::array<TextureWrap, 2> wrap) const {
  const auto place = [](float along, int size, TextureWrap how) {
    return wrapped(static_cast<int>(std::floor(along * static_cast<float>(size))), size, how);
  };
  return texel(level, place(uv.x, level.width, wrap[0]), place(uv.y, level.height, wrap[1]));
}

Texel Texture::bilinear(const Pixels& level, Vec2f uv, std::array<TextureWrap, 2> wrap) const {
  const float across = uv.x * static_cast<float>(level.width) - 0.5f,
              down = uv.y * static_cast<float>(level.height) - 0.5f;
  const float left = std::floor(across), top = std::floor(down);
  const float right_weight = across - left, bottom_weight = down - top;
  const int x = static_cast<int>(left), y = static_cast<int>(top);
  const int x0 = wrapped(x, level.width, wrap[0]), x1 = wrapped(x + 1, level.width, wrap[0]);
  const int y0 = wrapped(y, level.height, wrap[1]), y1 = wrapped(y + 1, level.height, wrap[1]);
  const Texel a = texel(level, x0, y0), b = texel(level, x1, y0), c = texel(level, x0, y1), d = texel(level, x1, y1);
  const auto mix = [&](auto p, auto q, auto r, auto s) {
    return (p * (1 - right_weight) + q * right_weight) * (1 - bottom_weight) +
           (r * (1 - right_weight) + s * right_weight) * bottom_weight;
  };
  return {mix(a.colour, b.colour, c.colour, d.colour), mix(a.alpha, b.alpha, c.alpha, d.alpha)};
}

Texel Texture::at(Vec2f uv, float footprint, std::array<TextureWrap, 2> wrap, bool nearest) const {
  uv = {inside(uv.x, wrap[0]), inside(uv.y, wrap[1])};
  if (nearest && footprint <= 1) return containing(levels_.front(), uv, wrap);
  const auto coarsest = static_cast<float>(levels_.size() - 1);
  const float level = footprint > 1 ? std::min(std::log2(footprint), coarsest) : 0;
  const auto fine = static_cast<size_t>(level);
  const float weight = level - static_cast<float>(fine);
  const Texel below = bilinear(levels_[fine], uv, wrap);
  if (weight == 0) return below;
  const Texel above = bilinear(levels_[fine + 1], uv, wrap);
  return {lerp(below.colour, above.colour, weight), below.alpha * (1 - weight) + above.alpha * weight};
}

size_t Texture::memory_bytes() const {
  size_t bytes = 0;
  for (const Pixels& level : levels_) bytes += level.codes.size() + level.values.size() * sizeof(float);
  return bytes;
}

}  // namespace kairos
