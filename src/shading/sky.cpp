#include "shading/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "image/texture.h"
#include "shading/luminance.h"

namespace kairos {

namespace {

/// Not negative, nor so large that sums of it overflow.
Vec3f sane(Vec3f c) {
  constexpr float kBrightest = 1e20f;
  const auto limited = [&](float v) { return v > 0 ? std::min(v, kBrightest) : 0; };
  return {limited(c.x), limited(c.y), limited(c.z)};
}

// Maps between directions in a picture's own space and places on it: EnvironmentLight says what they mean. Equal areas:
// P. Clarberg, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008.

Vec2d place_of(EnvironmentLight::Mapping mapping, Vec3d d) {
  if (mapping == EnvironmentLight::Mapping::latitude_longitude)
    return {0.5 + std::atan2(d.x, -d.z) / (2 * std::numbers::pi),
            std::acos(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi};
  const double x = std::abs(d.x), y = std::abs(d.y), radius = std::sqrt(std::max(0.0, 1 - std::abs(d.z)));
  const double angle = x == 0 && y == 0 ? 0 : std::atan2(y, x) * (2 / std::numbers::pi);
  Vec2d place{radius - angle * radius, angle * radius};
  if (d.z < 0) place = {1 - place.y, 1 - place.x};
  return {(std::copysign(place.x, d.x) + 1) / 2, (std::copysign(place.y, d.y) + 1) / 2};
}

Vec3d direction_of(EnvironmentLight::Mapping mapping, Vec2d place) {
  if (mapping == EnvironmentLight::Mapping::latitude_longitude) {
    const double longitude = (place.x - 0.5) * 2 * std::numbers::pi, polar = place.y * std::numbers::pi;
    return {std::sin(polar) * std::sin(longitude), std::cos(polar), -std::sin(polar) * std::cos(longitude)};
  }
  const double u = 2 * place.x - 1, v = 2 * place.y - 1, x = std::abs(u), y = std::abs(v);
  const double inside = 1 - (x + y), radius = 1 - std::abs(inside);
  const double angle = (radius == 0 ? 1 : (y - x) / radius + 1) * std::numbers::pi / 4;
  const double across = radius * std::sqrt(2 - radius * radius);
  return {std::copysign(std::cos(angle), u) * across, std::copysign(std::sin(angle), v) * across,
          std::copysign(1 - radius * radius, inside)};
}

// Cells in which a picture's directions are counted: those of a picture up to 2048 x 1024 are its texels.
constexpr double kMostCells = 1 << 21;

/// Where `target` lies in a running sum that ends above it: the index, and how far into its part, 0 to 1.
std::pair<size_t, double> find_in(const double* sums, size_t count, double target) {
  const auto above = std::upper_bound(sums, sums + count, target);
  const size_t index = std::min(static_cast<size_t>(above - sums), count - 1);
  const double begin = index == 0 ? 0 : sums[index - 1], width = sums[index] - begin;
  return {index, width > 0 ? std::clamp((target - begin) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

class Sky::Picture {
 public:
  Picture(const EnvironmentLight& light, std::shared_ptr<const Texture> texture, bool is_light)
      : light_(light), texture_(std::move(texture)) {
    if (!is_light) return;
    const double texels = static_cast<double>(texture_->width()) * texture_->height();
    texels_per_cell_ = std::max(1.0, std::sqrt(texels / kMostCells));
    const auto cells = [&](int size) {
      return static_cast<size_t>(std::max(1.0, std::floor(size / texels_per_cell_)));
    };
    width_ = cells(texture_->width());
    height_ = cells(texture_->height());
    make_sums(filtered_brightness());
  }

  double power() const { return rows_.empty() ? 0 : rows_.back(); }

  Vec3f radiance(Vec3d direction, double width) const {
    const double texel =
        (is_round() ? std::numbers::pi : std::sqrt(4 * std::numbers::pi)) / texture_->height();  // radians
    const Vec2d place = place_of(light_.mapping, local(direction));
    const TextureWrap sideways = is_round() ? TextureWrap::repeat : TextureWrap::clamp;
    const Texel seen = texture_->at({static_cast<float>(place.x), static_cast<float>(place.y)},
                                    static_cast<float>(width / texel), {sideways, TextureWrap::clamp});
    return sane(seen.colour * light_.radiance);
  }

  Vec3d sample(double u, double v) const {
    const auto [y, below] = find_in(rows_.data(), height_, v * rows_.back());
    const double* row = &columns_[y * width_];
    const auto [x, right] = find_in(row, width_, u * row[width_ - 1]);
    const Vec3d d = direction_of(light_.mapping, {(static_cast<double>(x) + right) / static_cast<double>(width_),
                                                  (static_cast<double>(y) + below) / static_cast<double>(height_)});
    return light_.axes[0] * d.x + light_.axes[1] * d.y + light_.axes[2] * d.z;
  }

  /// Times power().
  double density(Vec3d direction) const {
    const Vec2d place = place_of(light_.mapping, local(direction));
    const size_t x = index(place.x, width_), y = index(place.y, height_), at = y * width_ + x;
    const double weight = columns_[at] - (x == 0 ? 0 : columns_[at - 1]);
    const double per_area = weight * static_cast<double>(width_) * static_cast<double>(height_);
    if (!is_round()) return per_area / (4 * std::numbers::pi);
    const double sine = std::sin(place.y * std::numbers::pi);
    return sine > 0 ? per_area / (2 * std::numbers::pi * std::numbers::pi * sine) : 0;
  }

 private:
  bool is_round() const { return light_.mapping == EnvironmentLight::Mapping::latitude_longitude; }
  Vec3d local(Vec3d d) const { return {dot(light_.axes[0], d), dot(light_.axes[1], d), dot(light_.axes[2], d)}; }
  static size_t index(double place, size_t size) {
    return std::min(static_cast<size_t>(std::max(0.0, place * static_cast<double>(size))), size - 1);
  }

  /// About the mean over each cell of what radiance() gives there, which mixes texels with their neighbours: what
  /// shines into a cell from beside it must be found, too.
  std::vector<float> filtered_brightness() const {
    std::vector<float> plain(width_ * height_), filtered(width_ * height_);
    parallel_for(height_, 16, [&](size_t begin, size_t end) {
      for (size_t y = begin; y < end; ++y)
        for (size_t x = 0; x < width_; ++x) {
          const Texel texel = texture_->at({(static_cast<float>(x) + 0.5f) / static_cast<float>(width_),
                                            (static_cast<float>(y) + 0.5f) / static_cast<float>(height_)},
                                           static_cast<float>(texels_per_cell_));
          plain[y * width_ + x] = luminance(sane(texel.colour * light_.radiance));
        }
    });
    constexpr float kOwn = 0.75f, kBeside = 0.125f;  // of a tent that is one cell wide on either side
    parallel_for(height_, 16, [&](size_t begin, size_t end) {
      for (size_t y = begin; y < end; ++y) {
        const size_t above = y == 0 ? y : y - 1, below = std::min(y + 1, height_ - 1);
        const auto column = [&](size_t x) {
          return kOwn * plain[y * width_ + x] + kBeside * (plain[above * width_ + x] + plain[below * width_ + x]);
        };
        for (size_t x = 0; x < width_; ++x) {
          const size_t left = x > 0 ? x - 1 : is_round() ? width_ - 1 : 0;
          const size_t right = x + 1 < width_ ? x + 1 : is_round() ? 0 : x;
          filtered[y * width_ + x] = kOwn * column(x) + kBeside * (column(left) + column(right));
        }
      }
    });
    return filtered;
  }

  void make_sums(const std::vector<float>& brightness_of) {
    columns_.resize(width_ * height_);
    rows_.resize(height_);
    double sum = 0;
    for (size_t y = 0; y < height_; ++y) {
      const double scale = std::numbers::pi / static_cast<double>(height_);
      const double area =
          is_round() ? std::cos(static_cast<double>(y) * scale) - std::cos(static_cast<double>(y + 1) * scale) : 1;
      double row = 0;
      for (size_t x = 0; x < width_; ++x) {
        row += area * static_cast<double>(brightness_of[y * width_ + x]);
        columns_[y * width_ + x] = row;
      }
      rows_[y] = sum += row;
    }
  }

  EnvironmentLight light_;
  std::shared_ptr<const Texture> texture_;
  double texels_per_cell_ = 1;     // along each side
  size_t width_ = 1, height_ = 1;  // in cells
  std::vector<double> columns_;    // [y][x]: running sums of weights in each row
  std::vector<double> rows_;       // [y]: of the rows' sums
};

Sky::Sky(const Shot& shot, bool is_light) {
  for (size_t i = 0; i < shot.lights.size(); ++i) {
    const auto* light = std::get_if<EnvironmentLight>(&shot.lights[i]);
    if (light == nullptr || i >= shot.light_textures.size() || !shot.light_textures[i]) continue;
    pictures_.emplace_back(*light, shot.light_textures[i], is_light);
    power_ += pictures_.back().power();
  }
}
Sky::~Sky() = default;

Vec3f Sky::radiance(Vec3d direction, double width) const {
  Vec3f sum{};
  for (const Picture& picture : pictures_) sum += picture.radiance(direction, width);
  return sum;
}

std::optional<Vec3d> Sky::sample(const std::array<float, 3>& sample) const {
  if (!(power_ > 0)) return std::nullopt;
  double target = static_cast<double>(sample[2]) * power_;
  size_t chosen = 0;
  while (chosen + 1 < pictures_.size() && target >= pictures_[chosen].power()) target -= pictures_[chosen++].power();
  if (!(pictures_[chosen].power() > 0)) return std::nullopt;
  return pictures_[chosen].sample(sample[0], sample[1]);
}

double Sky::density(Vec3d direction) const {
  if (!(power_ > 0)) return 0;
  double sum = 0;
  for (const Picture& picture : pictures_) sum += picture.density(direction);
  return sum / power_;
}

}  // namespace kairos
