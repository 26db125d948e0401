// What each mesh contributes to a square of pixels over time, and how far away it is.
#pragma once

#include <cstdint>
#include <vector>

#include "film/time_tile.h"

namespace kairos {

/// Functions of time, one after the other: straight lines between a piece's ends, +infinity where there is nothing.
struct DepthPieces {
  std::vector<uint32_t> first;     ///< [function], and the end of the last one: of its pieces, at least one
  std::vector<uint32_t> begin;     ///< [piece]: ticks (see time_signal.h); a function's first is 0, and they ascend
  std::vector<float> left, right;  ///< [piece]: at its beginning and at its end; both finite, or both +infinity
};

struct ObjectTile {
  std::vector<uint32_t> first;  ///< [pixel], and the end of the last one: of its meshes
  std::vector<uint32_t> mesh;   ///< [mesh seen in a pixel]: its number; ascending in a pixel
  TimeTile signals;             ///< of so many: premultiplied colour and coverage
  DepthPieces depth;            ///< of so many: the nearest distance along the view axis, of what is seen of the mesh

  size_t pixels() const { return first.empty() ? 0 : first.size() - 1; }
  bool empty() const { return first.empty(); }
};

}  // namespace kairos
