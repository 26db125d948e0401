// Triangles seen from their other side.
#pragma once

#include <map>
#include <utility>

#include <kairos/mesh.h>

#include "scene/shared_array.h"

namespace kairos {

/// Turns triangles round for meshes that a transform mirrors: once for all meshes that share them.
class TurnedTriangles {
 public:
  SharedArray<Triangle> of(const SharedArray<Triangle>& triangles) {
    const auto [place, is_new] = known_.try_emplace(triangles.identity(), triangles, triangles);
    auto& [original, turned] = place->second;
    if (is_new)
      for (Triangle& triangle : turned.edit()) std::swap(triangle[1], triangle[2]);
    return turned;
  }

 private:
  std::map<const void*, std::pair<SharedArray<Triangle>, SharedArray<Triangle>>> known_;  // by the first of both
};

}  // namespace kairos
