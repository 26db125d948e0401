// The nodes of a tree as the builder leaves them -> as kernels read them.
#pragma once

#include <span>
#include <vector>

#include "accel/builder.h"
#include "accel/layout.h"
#include "base/parallel.h"

namespace kairos {

/// Nodes, with the blocks below them, per piece of a parallel loop.
constexpr uint32_t kNodeGrain = 256;

/// Children of a node; its leaves are numbered from `first_leaf` on.
template <int kKeys>
void set_node(const WideNode& from, uint32_t first_leaf, Node<kKeys>& to) {
  to.count = from.child_count;
  for (uint32_t slot = 0; slot < kWidth; ++slot) {
    const WideChild& child = from.child[slot < from.child_count ? slot : 0];
    for (int key = 0; key < kKeys; ++key)
      for (int axis = 0; axis < 3; ++axis) {
        to.lower[key][axis][slot] = child.box().lower(key, axis);
        to.upper[key][axis][slot] = child.box().upper(key, axis);
      }
    to.child[slot] = slot >= from.child_count ? kNoNode : child.is_leaf() ? kLeafBit | first_leaf++ : child.node();
  }
}

/// The triangles of a leaf, and when it is there.
struct Leaf {
  std::span<const TriangleId> triangles;
  TimeRange window;

  TriangleId in_slot(uint32_t slot) const { return triangles[slot < triangles.size() ? slot : 0]; }
};

/// The leaves in the order of their nodes, so that neighbours in the tree are neighbours in memory; sets nodes and
/// root.
template <class TreeOfNodes>
std::vector<Leaf> set_nodes(const WideTree& wide, TreeOfNodes& tree) {
  std::vector<Leaf> leaves;
  tree.depth = wide.depth;
  if (wide.order.empty()) return leaves;
  const std::span<const TriangleId> order(wide.order);
  if (wide.nodes.empty()) {
    tree.root = kLeafBit;
    leaves.push_back({order, {}});
    return leaves;
  }
  tree.root = 0;
  std::vector<uint32_t> first_leaf(wide.nodes.size());
  uint32_t count = 0;
  for (size_t n = 0; n < wide.nodes.size(); ++n) {
    first_leaf[n] = count;
    count += wide.nodes[n].leaf_count;
  }
  leaves.resize(count);
  tree.nodes.resize(wide.nodes.size());
  parallel_for(wide.nodes.size(), kNodeGrain, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const WideNode& node = wide.nodes[n];
      set_node(node, first_leaf[n], tree.nodes[n]);
      uint32_t leaf = first_leaf[n];
      for (uint32_t c = 0; c < node.child_count; ++c)
        if (node.child[c].is_leaf())
          leaves[leaf++] = {order.subspan(node.child[c].begin(), node.child[c].count()), node.child[c].window()};
    }
  });
  return leaves;
}

}  // namespace kairos
