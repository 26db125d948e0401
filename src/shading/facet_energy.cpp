#include "shading/facet_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "shading/microfacets.h"

namespace kairos {

namespace {

constexpr size_t kCosines = 32, kRoughnesses = 16;
constexpr int kDirections = 512;  // of each entry's mean

/// By visible facets, whose density cancels all but their shadowing: a smooth mean, of evenly spread points.
double mean_reflected_once(double cosine, double alpha) {
  const Vec3d normal{0, 0, 1}, viewer{std::sqrt(1 - cosine * cosine), 0, cosine};
  double sum = 0, v = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double u = (i + 0.5) / kDirections;
    v += 0.6180339887498949;
    v -= std::floor(v);
    const Vec3d light = lobe_direction(normal, viewer, alpha, static_cast<float>(u), static_cast<float>(v));
    if (!(light.z > 0)) continue;
    sum += highlight_lobe(normal, viewer, light, alpha) * light.z / lobe_density(normal, viewer, light, alpha);
  }
  return sum / kDirections;
}

// Entries lie evenly over the roots of cosine and alpha: both matter most where they are small.
using Table = std::array<std::array<double, kCosines>, kRoughnesses>;

double value_at(size_t entry, size_t entries) {
  constexpr double kLeast = 1e-6;  // at nothing, there is no lobe
  const double root = static_cast<double>(entry) / static_cast<double>(entries - 1);
  return std::max(kLeast, root * root);
}

Table make_table() {
  Table table{};
  for (size_t r = 0; r < kRoughnesses; ++r)
    for (size_t c = 0; c < kCosines; ++c)
      table[r][c] = mean_reflected_once(value_at(c, kCosines), value_at(r, kRoughnesses));
  return table;
}

struct Between {
  size_t before;
  double beyond;  // of the next one
};
Between find_between(double value, size_t entries) {
  const auto last = static_cast<double>(entries - 1);
  const double place = std::clamp(std::sqrt(std::max(value, 0.0)) * last, 0.0, last);
  const size_t before = std::min(static_cast<size_t>(place), entries - 2);
  return {before, place - static_cast<double>(before)};
}

}  // namespace

double reflected_once(double cosine, double alpha) {
  static const Table table = make_table();
  const auto [r, rough] = find_between(alpha, kRoughnesses);
  const auto [c, on] = find_between(cosine, kCosines);
  const double smoother = table[r][c] + (table[r][c + 1] - table[r][c]) * on;
  const double rougher = table[r + 1][c] + (table[r + 1][c + 1] - table[r + 1][c]) * on;
  return smoother + (rougher - smoother) * rough;
}

}  // namespace kairos
