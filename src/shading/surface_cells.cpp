#include "shading/surface_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

std::span<const Vec3f> SurfaceCells::answer(const LookUps& look_ups, uint64_t seed) {
  own_surfaces_.resize(look_ups.count());
  shader_.own_light(look_ups.queries(), options_.share_asked, own_surfaces_);
  return answer(look_ups, own_surfaces_, seed);
}

std::span<const Vec3f> SurfaceCells::answer(const LookUps& look_ups, std::span<const SharedSurface> surfaces,
                                            uint64_t seed) {
  const std::span<const ShadingQuery> queries = look_ups.queries();
  surfaces_ = surfaces;
  cells_.clear();
  slots_.assign(size_t{1} << 12, kNone);
  assign(queries);
  sort_by_cell();
  shade(queries, seed);
  colours_.resize(queries.size());
  for (size_t i = 0; i < queries.size(); ++i) colours_[i] = surfaces_[i].own;
  share();
  return colours_;
}

void SurfaceCells::assign(std::span<const ShadingQuery> queries) {
  cell_of_.resize(queries.size());
  places_.resize(queries.size());
  for (size_t i = 0; i < queries.size(); ++i) {
    const bool shares = surfaces_[i].reflects != Vec3f{};
    cell_of_[i] = shares ? find(key_of(queries[i], surfaces_[i], places_[i])) : kNone;
    if (shares) ++cells_[cell_of_[i]].look_ups;
  }
}

SurfaceCells::Key SurfaceCells::key_of(const ShadingQuery& query, const SharedSurface& surface, Place& within) const {
  const std::array<Vec3d, 3> rest = triangle_at(shader_.shot().meshes[query.mesh], query.triangle, KeyPosition{});
  const Vec3d point = point_of(rest, surface.weights);
  const double wanted = std::log2(options_.side * query.width);
  const int exponent = std::isfinite(wanted)
                           ? static_cast<int>(std::lround(std::clamp<double>(wanted, -kMostExponent, kMostExponent)))
                           : 0;
  const double cells_per_unit = std::ldexp(1.0, -exponent);
  std::array<int32_t, 3> place;
  for (size_t k = 0; k < 3; ++k) {
    const double at = point[static_cast<int>(k)] * cells_per_unit, whole = std::floor(at);
    place[k] = static_cast<int32_t>(std::clamp(whole, -kMostPlace, kMostPlace));
    within[k] = static_cast<float>(at - whole);
  }
  const double in_slices = static_cast<double>(query.time) * options_.slices;
  const auto slice = static_cast<uint32_t>(std::min(static_cast<double>(options_.slices - 1), in_slices));
  within[3] = static_cast<float>(in_slices - slice);
  const uint32_t direction = direction_class(geometric_normal(rest));
  const uint32_t words = (static_cast<uint32_t>(exponent + kMostExponent) * 27 + direction) * 2 + surface.front;
  return {query.mesh, place, words * options_.slices + slice};
}

uint32_t SurfaceCells::find(const Key& key) {
  size_t slot = hash_of(key.mesh, key.place, key.rest) & (slots_.size() - 1);
  while (slots_[slot] != kNone) {
    if (cells_[slots_[slot]].key == key) return slots_[slot];
    slot = (slot + 1) & (slots_.size() - 1);
  }
  slots_[slot] = static_cast<uint32_t>(cells_.size());
  cells_.push_back({key});
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
  chosen_look_up_.clear();
  double phase = static_cast<double>(unit_float(hash(seed, kLightDimension)));
  const uint64_t light_seed = hash(seed, kLightDimension, 1);
  for (Cell& cell : cells_) {
    const auto wanted = static_cast<uint32_t>(std::max(1.0, std::floor(options_.rate * cell.look_ups + 0.5)));
    const uint32_t count = std::min(wanted, cell.look_ups);
    cell.first_chosen = static_cast<uint32_t>(chosen_.size());
    phase += kGoldenShare;
    phase -= std::floor(phase);
    for (uint32_t i = 0; i < count; ++i) {
      const auto which = static_cast<uint32_t>((i + phase) * cell.look_ups / count);
      const uint32_t look_up = in_cells_[cell.first + std::min(which, cell.look_ups - 1)];
      ShadingQuery query = queries[look_up];
      query.key = {light_seed, static_cast<uint32_t>(chosen_.size())};
      chosen_.push_back(query);
      chosen_look_up_.push_back(look_up);
    }
  }
  evaluations_ += chosen_.size();
  chosen_light_.resize(chosen_.size());
  shader_.shared_light(chosen_, options_.share_asked, chosen_light_);
}

void SurfaceCells::share() {
  order_.resize(chosen_.size());
  brightness_.resize(chosen_.size());
  const auto sum = [](const Vec3f& v) { return v.x + v.y + v.z; };
  for (uint32_t i = 0; i < chosen_.size(); ++i) {
    order_[i] = i;
    brightness_[i] = sum(chosen_light_[i]) / sum(surfaces_[chosen_look_up_[i]].reflects);
  }
  for (size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const size_t end = c + 1 < cells_.size() ? cells_[c + 1].first_chosen : chosen_.size();
    share({std::span(in_cells_).subspan(cell.first, cell.look_ups),
           std::span(order_).subspan(cell.first_chosen, end - cell.first_chosen)});
  }
}

void SurfaceCells::share(Part part) {
  if (const size_t axis = clearest_axis(part); axis < 4) {
    const float middle = (part.low[axis] + part.high[axis]) / 2;
    const auto split = [&](std::span<uint32_t> all, const auto& look_up_of) {
      const auto is_lower = [&](uint32_t i) { return places_[look_up_of(i)][axis] < middle; };
      return static_cast<size_t>(std::stable_partition(all.begin(), all.end(), is_lower) - all.begin());
    };
    const size_t look_ups = split(part.look_ups, [](uint32_t i) { return i; });
    const size_t chosen = split(part.chosen, [&](uint32_t i) { return chosen_look_up_[i]; });
    Part lower{part.look_ups.first(look_ups), part.chosen.first(chosen), part.low, part.high};
    Part upper{part.look_ups.subspan(look_ups), part.chosen.subspan(chosen), part.low, part.high};
    lower.high[axis] = upper.low[axis] = middle;
    share(lower);
    share(upper);
    return;
  }
  Vec3f light{}, reflects{};
  for (const uint32_t i : part.chosen) {
    light += chosen_light_[i];
    reflects += surfaces_[chosen_look_up_[i]].reflects;
  }
  // Of a colour that the shaded surfaces do not reflect nothing is known: the light is taken for white.
  const float white = (light.x + light.y + light.z) / (reflects.x + reflects.y + reflects.z);
  for (int k = 0; k < 3; ++k) light[k] = reflects[k] > 0 ? light[k] / reflects[k] : white;
  for (const uint32_t i : part.look_ups) colours_[i] += surfaces_[i].reflects * light;
}

size_t SurfaceCells::clearest_axis(const Part& part) const {
  constexpr size_t kLeastChosen = 4;  // in either half
  /// Squared, of the difference, in its standard errors: noise alone hardly ever gets there.
  constexpr double kClear = 9;
  if (part.chosen.size() < 2 * kLeastChosen) return 4;
  size_t clearest = 4;
  double most = kClear;
  for (size_t axis = 0; axis < 4; ++axis) {
    const float middle = (part.low[axis] + part.high[axis]) / 2;
    std::array<double, 2> count{}, sum{}, squares{};
    for (const uint32_t i : part.chosen) {
      const size_t half = places_[chosen_look_up_[i]][axis] < middle ? 0 : 1;
      const auto value = static_cast<double>(brightness_[i]);
      count[half] += 1;
      sum[half] += value;
      squares[half] += value * value;
    }
    if (std::min(count[0], count[1]) < kLeastChosen) continue;
    const auto squared_error = [&](size_t half) {
      return std::max(0.0, squares[half] - sum[half] * sum[half] / count[half]) / (count[half] * (count[half] - 1));
    };
    const double lead = sum[0] / count[0] - sum[1] / count[1], noise = squared_error(0) + squared_error(1);
    if (!(lead * lead > most * noise) || !(lead * lead > 0)) continue;
    clearest = axis;
    most = noise > 0 ? lead * lead / noise : std::numeric_limits<double>::infinity();
  }
  return clearest;
}

}  // namespace kairos
