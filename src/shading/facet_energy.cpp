#include "shading/facet_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>

#include "shading/microfacets.h"
#include "shading/reflectance.h"

namespace kairos {

namespace {

constexpr size_t kCosines = 32, kRoughnesses = 16, kIndices = 40;
constexpr int kDirections = 512, kGlassDirections = 256;  // of each entry's mean

/// The mean of share(facet, viewer) over facets that the viewer sees, evenly spread. cosine, alpha: as of
/// reflected_once().
template <class Share>
double mean_over_facets(double cosine, double alpha, int count, const Share& share) {
  const Vec3d viewer{std::sqrt(1 - cosine * cosine), 0, cosine};
  double sum = 0, v = 0;
  for (int i = 0; i < count; ++i) {
    const double u = (i + 0.5) / count;
    v += 0.6180339887498949;
    v -= std::floor(v);
    sum += share(visible_facet({0, 0, 1}, viewer, alpha, static_cast<float>(u), static_cast<float>(v)), viewer);
  }
  return sum / count;
}

/// Of light that a visible facet sends to where it has the cosine, the part that no other facet hides: what is left of
/// highlight_lobe() and its like, divided by their density.
double unhidden(double n_v, double n_l, double alpha) {
  const double slant = facet_slant(n_v, alpha);
  return n_l > 0 ? n_l * (n_v + slant) / (n_l * slant + n_v * facet_slant(n_l, alpha)) : 0;
}

double mean_reflected_once(double cosine, double alpha) {
  return mean_over_facets(cosine, alpha, kDirections, [&](Vec3d facet, Vec3d viewer) {
    return unhidden(cosine, reflected(-viewer, facet).z, alpha);
  });
}

double mean_of_glass(double cosine, double alpha, double eta) {
  return mean_over_facets(cosine, alpha, kGlassDirections, [&](Vec3d facet, Vec3d viewer) {
    const double on_facet = std::clamp(dot(facet, viewer), 0.0, 1.0), back = fresnel(on_facet, eta);
    const double sent_back = back * unhidden(cosine, reflected(-viewer, facet).z, alpha);
    return back < 1 ? sent_back + (1 - back) * unhidden(cosine, -refracted(-viewer, facet, eta).z, alpha) : sent_back;
  });
}

// Entries lie evenly over the roots of cosine and alpha: both matter most where they are small.
using Table = std::array<std::array<double, kCosines>, kRoughnesses>;

double value_at(size_t entry, size_t entries) {
  constexpr double kLeast = 1e-6;  // at nothing, there is no lobe
  const double root = static_cast<double>(entry) / static_cast<double>(entries - 1);
  return std::max(kLeast, root * root);
}

template <class Mean>
Table make_table(const Mean& mean) {
  Table table{};
  for (size_t r = 0; r < kRoughnesses; ++r)
    for (size_t c = 0; c < kCosines; ++c) table[r][c] = mean(value_at(c, kCosines), value_at(r, kRoughnesses));
  return table;
}

struct Between {
  size_t before;
  double beyond;  // of the next one
};
/// share: of the way through the entries.
Between find_between(double share, size_t entries) {
  const auto last = static_cast<double>(entries - 1);
  const double place = std::clamp(share * last, 0.0, last);
  const size_t before = std::min(static_cast<size_t>(place), entries - 2);
  return {before, place - static_cast<double>(before)};
}

double read_table(const Table& table, double cosine, double alpha) {
  const auto [r, rough] = find_between(std::sqrt(std::max(alpha, 0.0)), kRoughnesses);
  const auto [c, on] = find_between(std::sqrt(std::max(cosine, 0.0)), kCosines);
  const double smoother = table[r][c] + (table[r][c + 1] - table[r][c]) * on;
  const double rougher = table[r + 1][c] + (table[r + 1][c + 1] - table[r + 1][c]) * on;
  return smoother + (rougher - smoother) * rough;
}

// Of refractive indices eta, entries lie evenly over (eta - 1) / (eta + 1), from a third to 3.
constexpr double kMostIndex = 0.5;

/// Made when it is first asked for: scenes have few kinds of glass.
const Table& glass_table(size_t index) {
  static std::array<Table, kIndices> tables;
  static std::array<std::once_flag, kIndices> made;
  std::call_once(made[index], [&] {
    const double place = kMostIndex * (2 * static_cast<double>(index) / (kIndices - 1) - 1),
                 eta = (1 + place) / (1 - place);
    tables[index] = make_table([&](double cosine, double alpha) { return mean_of_glass(cosine, alpha, eta); });
  });
  return tables[index];
}

}  // namespace

double reflected_once(double cosine, double alpha) {
  static const Table table = make_table(mean_reflected_once);
  return read_table(table, cosine, alpha);
}

double reflected_or_refracted_once(double cosine, double alpha, double eta) {
  const double index = (eta - 1) / (eta + 1);
  const auto [i, on] = find_between((index / kMostIndex + 1) / 2, kIndices);
  const double before = read_table(glass_table(i), cosine, alpha);
  return before + (read_table(glass_table(i + 1), cosine, alpha) - before) * on;
}

}  // namespace kairos
