// Builds the topology of an eight-wide tree over moving boxes by a binned surface-area heuristic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/layout.h"
#include "accel/moving_box.h"

namespace kairos {

/// A thing to be put into a tree.
struct Primitive {
  MovingBox box;
  uint32_t mesh, triangle;
};

/// Children are ranges of the primitives as the builder has reordered them.
struct WideChild {
  MovingBox box;
  uint32_t begin = 0, count = 0;  ///< primitives
  NodeRef node = kNoNode;         ///< index into WideTree::nodes; kNoNode for a leaf of at most kWidth primitives
};

struct WideNode {
  std::array<WideChild, kWidth> child;
  uint32_t child_count = 0;
};

struct WideTree {
  std::vector<WideNode> nodes;  ///< nodes[0] is the root; empty when one leaf holds all primitives
  uint32_t depth = 0;
};

/// Reorders `primitives`. Parallel; the result does not depend on the number of threads. `moving`: also split by
/// velocity.
WideTree build_wide_tree(std::span<Primitive> primitives, bool moving);

}  // namespace kairos
