// Light that arrives at cells of surfaces, shared by all that see them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shading/look_ups.h"
#include "shading/shader.h"

namespace kairos {

struct CellOptions {
  double side = 2;          ///< of a cell, in pixels, to a factor of sqrt(2)
  double rate = 0.25;       ///< of the look-ups that fall into a cell, so many are shaded; at least one is
  uint32_t slices = 1;      ///< of the shutter, in which cells differ
  bool share_asked = true;  ///< see LitShading::own_light
};

/// Answers look-ups: each falls into a cell of the surface that it sees, which moves along with it, and gets the mean
/// light of those look-ups of the cell that are shaded, times what it reflects itself. A cell is halved, along an axis
/// or in time, where these say that light differs between its halves by clearly more than its noise.
/// docs/method.md, "Surface cells". One thread's scratch memory.
class SurfaceCells {
 public:
  SurfaceCells(const Shader& shader, const CellOptions& options) : shader_(shader), options_(options) {}

  /// What the look-ups see, in their order, not yet `limited`; valid until the next call. The same for the same
  /// look-ups and seed.
  std::span<const Vec3f> answer(const LookUps& look_ups, uint64_t seed);
  /// For those who ask cells of several kinds: what Shader::own_light gives of the look-ups, in their order.
  std::span<const Vec3f> answer(const LookUps& look_ups, std::span<const SharedSurface> surfaces, uint64_t seed);

  Vec3f limited(Vec3f colour) const { return shader_.limited(colour); }
  uint64_t evaluations() const { return evaluations_; }

 private:
  /// Where on which surface, when.
  struct Key {
    uint32_t mesh = 0;
    std::array<int32_t, 3> place{};  // in units of the cell's side, on the mesh as it is at its first key
    uint32_t rest = 0;               // size, side, direction and slice
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Cell {
    Key key;
    uint32_t look_ups = 0, first = 0;  // of its look-ups in in_cells_
    uint32_t first_chosen = 0;         // of those that are shaded
  };
  using Place = std::array<float, 4>;  // within a cell, in space and time
  /// Of a cell.
  struct Part {
    std::span<uint32_t> look_ups, chosen;
    Place low{0, 0, 0, 0}, high{1, 1, 1, 1};
  };

  Key key_of(const ShadingQuery& query, const SharedSurface& surface, Place& place) const;
  void assign(std::span<const ShadingQuery> queries);
  uint32_t find(const Key& key);
  void grow_table();
  void sort_by_cell();
  void shade(std::span<const ShadingQuery> queries, uint64_t seed);
  void share();
  void share(Part part);
  /// Of a part whose halves differ clearly, along which axis they do most; none: 4.
  size_t clearest_axis(const Part& part) const;

  const Shader& shader_;
  CellOptions options_;
  std::vector<SharedSurface> own_surfaces_;
  std::span<const SharedSurface> surfaces_;  // [look-up]
  std::vector<uint32_t> cell_of_;            // [look-up]; kNone: nothing of it is shared
  std::vector<uint32_t> slots_;              // [hash]: number of a cell, or kNone; a power of two, less than half full
  std::vector<Cell> cells_;                  // in order of first sight
  std::vector<uint32_t> in_cells_;           // look-ups, cell by cell
  std::vector<Place> places_;                // [look-up]
  std::vector<ShadingQuery> chosen_;         // to be shaded, cell by cell
  std::vector<uint32_t> chosen_look_up_;
  std::vector<Vec3f> chosen_light_;
  std::vector<float> brightness_;  // [chosen]: of the light that arrives
  std::vector<uint32_t> order_;    // of what is chosen, part by part
  std::vector<Vec3f> colours_;
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
