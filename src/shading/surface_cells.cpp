#include "shading/surface_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/hash.h"
#include "shading/surface.h"

namespace kairos {

namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr uint64_t kLightDimension = 0x63656c6c;
constexpr double kGoldenShare = 0.6180339887498949;
/// Cells are no smaller and no larger than 2 to the power of this many scene units.
constexpr int kMostExponent = 100;
constexpr double kMostPlace = 1 << 30;

/// A third of the way to the next axis and more is another direction.
uint32_t direction_class(Vec3d normal) {
  const auto third = [](double v) { return static_cast<uint32_t>(std::lround(v * 1.4) + 1); };
  return (third(normal.x) * 3 + third(normal.y)) * 3 + third(normal.z);
}

uint64_t hash_of(uint32_t mesh, const std::array<int32_t, 3>& place, uint32_t rest) {
  const auto word = [](uint32_t high, int32_t low) { return uint64_t{high} << 32 | static_cast<uint32_t>(low); };
  return mix64(mix64(word(mesh, place[0])) ^ (word(rest, place[1]) * 0x9e3779b97f4a7c15u) ^
               (word(0, place[2]) * 0xd6e8feb86659fd93u));
}

}  // namespace

std::span<const Vec3f> SurfaceCells::answer(LookUps& look_ups, uint64_t seed) {
  const std::span<ShadingQuery> queries = look_ups.queries();
  cells_.clear();
  slots_.assign(size_t{1} << 12, kNone);
  assign(queries);
  sort_by_cell();
  shade(queries, seed);
  colours_.resize(queries.size());
  for (size_t i = 0; i < queries.size(); ++i) {
    Vec3f colour = surfaces_[i].own;
    if (cell_of_[i] != kNone) colour += surfaces_[i].reflects * cells_[cell_of_[i]].light;
    colours_[i] = colour;
  }
  return colours_;
}

void SurfaceCells::assign(std::span<ShadingQuery> queries) {
  surfaces_.resize(queries.size());
  cell_of_.resize(queries.size());
  shader_.own_light(queries, options_.share_asked, surfaces_);
  for (size_t i = 0; i < queries.size(); ++i) {
    const bool shares = surfaces_[i].reflects != Vec3f{};
    cell_of_[i] = shares ? find(key_of(queries[i], surfaces_[i])) : kNone;
    if (shares) ++cells_[cell_of_[i]].look_ups;
  }
}

SurfaceCells::Key SurfaceCells::key_of(const ShadingQuery& query, const SharedSurface& surface) const {
  const std::array<Vec3d, 3> rest = triangle_at(shader_.shot().meshes[query.mesh], query.triangle, KeyPosition{});
  const Vec3d point = point_of(rest, surface.weights);
  const double wanted = std::log2(options_.side * query.width);
  const int exponent = std::isfinite(wanted)
                           ? static_cast<int>(std::lround(std::clamp<double>(wanted, -kMostExponent, kMostExponent)))
                           : 0;
  const double cells_per_unit = std::ldexp(1.0, -exponent);
  const auto place = [&](double v) {
    return static_cast<int32_t>(std::clamp(std::floor(v * cells_per_unit), -kMostPlace, kMostPlace));
  };
  const auto slice = static_cast<uint32_t>(
      std::min(static_cast<double>(options_.slices - 1), static_cast<double>(query.time) * options_.slices));
  const uint32_t direction = direction_class(geometric_normal(rest));
  const uint32_t words = (static_cast<uint32_t>(exponent + kMostExponent) * 27 + direction) * 2 + surface.front;
  return {query.mesh, {place(point.x), place(point.y), place(point.z)}, words * options_.slices + slice};
}

uint32_t SurfaceCells::find(const Key& key) {
  size_t slot = hash_of(key.mesh, key.place, key.rest) & (slots_.size() - 1);
  while (slots_[slot] != kNone) {
    if (cells_[slots_[slot]].key == key) return slots_[slot];
    slot = (slot + 1) & (slots_.size() - 1);
  }
  slots_[slot] = static_cast<uint32_t>(cells_.size());
  cells_.push_back({key, 0, 0, {}, {}});
  if (2 * cells_.size() >= slots_.size()) grow_table();
  return static_cast<uint32_t>(cells_.size() - 1);
}

void SurfaceCells::grow_table() {
  slots_.assign(4 * slots_.size(), kNone);
  for (uint32_t i = 0; i < cells_.size(); ++i) {
    const Key& key = cells_[i].key;
    size_t slot = hash_of(key.mesh, key.place, key.rest) & (slots_.size() - 1);
    while (slots_[slot] != kNone) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = i;
  }
}

void SurfaceCells::sort_by_cell() {
  uint32_t first = 0;
  for (Cell& cell : cells_) {
    cell.first = first;
    first += cell.look_ups;
    cell.look_ups = 0;
  }
  in_cells_.resize(first);
  for (uint32_t i = 0; i < cell_of_.size(); ++i)
    if (cell_of_[i] != kNone) {
      Cell& cell = cells_[cell_of_[i]];
      in_cells_[cell.first + cell.look_ups++] = i;
    }
}

/// Light samples are numbered through all cells in their order, so that those of neighbours are spread.
void SurfaceCells::shade(std::span<const ShadingQuery> queries, uint64_t seed) {
  chosen_.clear();
  chosen_cell_.clear();
  double phase = static_cast<double>(unit_float(hash(seed, kLightDimension)));
  const uint64_t light_seed = hash(seed, kLightDimension, 1);
  for (uint32_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const auto wanted = static_cast<uint32_t>(std::max(1.0, std::floor(options_.rate * cell.look_ups + 0.5)));
    const uint32_t count = std::min(wanted, cell.look_ups);
    phase += kGoldenShare;
    phase -= std::floor(phase);
    for (uint32_t i = 0; i < count; ++i) {
      const auto which = static_cast<uint32_t>((i + phase) * cell.look_ups / count);
      ShadingQuery query = queries[in_cells_[cell.first + std::min(which, cell.look_ups - 1)]];
      cells_[c].reflects += surfaces_[in_cells_[cell.first + std::min(which, cell.look_ups - 1)]].reflects;
      query.key = {light_seed, static_cast<uint32_t>(chosen_.size())};
      chosen_.push_back(query);
      chosen_cell_.push_back(c);
    }
  }
  evaluations_ += chosen_.size();
  chosen_light_.resize(chosen_.size());
  shader_.shared_light(chosen_, options_.share_asked, chosen_light_);
  for (size_t i = 0; i < chosen_.size(); ++i) cells_[chosen_cell_[i]].light += chosen_light_[i];
  for (Cell& cell : cells_) {
    // Of a colour that the shaded surfaces do not reflect nothing is known: the light is taken for white.
    const Vec3f &light = cell.light, &reflects = cell.reflects;
    const float white = (light.x + light.y + light.z) / (reflects.x + reflects.y + reflects.z);
    for (int k = 0; k < 3; ++k) cell.light[k] = reflects[k] > 0 ? light[k] / reflects[k] : white;
  }
}

}  // namespace kairos
