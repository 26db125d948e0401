// Builds the topology of an eight-wide tree over moving boxes by a binned surface-area heuristic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/box_lanes.h"
#include "accel/layout.h"

namespace kairos {

/// Children are ranges of the triangles in the order that the builder gives them. Lanes that are no part of the box
/// hold the rest, so that a child is one cache line.
class WideChild {
 public:
  void set(const BoxLanes& box, uint32_t begin, uint32_t count, NodeRef node) {
    box_ = box;
    box_.bound[0][3] = std::bit_cast<float>(begin);
    box_.bound[1][3] = std::bit_cast<float>(count);
    box_.bound[2][3] = std::bit_cast<float>(node);
  }
  void move_node(NodeRef offset) { box_.bound[2][3] = std::bit_cast<float>(node() + offset); }

  const BoxLanes& box() const { return box_; }
  uint32_t begin() const { return std::bit_cast<uint32_t>(box_.bound[0][3]); }
  uint32_t count() const { return std::bit_cast<uint32_t>(box_.bound[1][3]); }
  NodeRef node() const { return std::bit_cast<NodeRef>(box_.bound[2][3]); }  ///< index into WideTree::nodes
  bool is_leaf() const { return node() == kNoNode; }                         ///< of at most kWidth triangles

 private:
  BoxLanes box_;
};

struct WideNode {
  std::array<WideChild, kWidth> child;
  uint32_t child_count, leaf_count;

  WideNode() {}  // NOLINT(modernize-use-equals-default): a kilobyte that need not be zero first
};

struct WideTree {
  std::vector<WideNode> nodes;  ///< nodes[0] is the root; empty when one leaf holds all triangles
  uint32_t depth = 0;
};

/// `primitives` are used up; `order` (as many) receives the triangles as the tree's leaves refer to them. `moving`:
/// also split by velocity. Parallel; the result does not depend on the number of threads nor on the instruction set.
WideTree build_wide_tree(std::span<Primitive> primitives, bool moving, std::span<TriangleId> order);

}  // namespace kairos
