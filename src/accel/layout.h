// Memory layout of the accelerator: the one thing that builders and kernels share.
//
// Eight-wide trees. A moving node holds its children's boxes at the two ends of one key span, between which their faces
// move linearly; a leaf is one block of up to eight triangles, vertices at both ends beside each other, so that a
// kernel reads plain vectors and never the meshes. What stands still has trees and blocks of its own, at half the size.
#pragma once

#include <cstdint>
#include <vector>

#include "base/large_array.h"

namespace kairos {

/// Children per node and triangles per leaf block: one AVX2 register of floats.
inline constexpr uint32_t kWidth = 8;

/// What a child slot or a root refers to: a node or, with kLeafBit set, a block.
using NodeRef = uint32_t;
inline constexpr NodeRef kLeafBit = 0x80000000u;
inline constexpr NodeRef kNoNode = 0xffffffffu;

/// Number of motion states stored: one for static geometry, two for a key span.
inline constexpr int kStaticKeys = 1;
inline constexpr int kMovingKeys = 2;

template <int kKeys>
struct alignas(64) Node {
  float lower[kKeys][3][kWidth];  ///< [key][axis][child]
  float upper[kKeys][3][kWidth];
  NodeRef child[kWidth];
  uint32_t count;  ///< children 0 to count - 1 exist; the other slots repeat child 0's box
};

/// Aligned to what one row of it is long: at 64 bytes a twentieth would be padding.
template <int kKeys>
struct alignas(32) TriangleBlock {
  float position[kKeys][3][3][kWidth];  ///< [key][vertex][axis][triangle]
  uint32_t mesh[kWidth];
  uint32_t triangle[kWidth];
  uint32_t count;  ///< triangles 0 to count - 1 exist; the other slots repeat triangle 0
};

template <int kKeys>
struct Tree {
  LargeArray<Node<kKeys>> nodes;
  LargeArray<TriangleBlock<kKeys>> blocks;
  NodeRef root = kNoNode;
  uint32_t depth = 0;                  ///< nodes on the longest way from the root to a block
  float time_begin = 0, time_end = 1;  ///< shutter time of the two keys

  size_t memory_bytes() const { return nodes.size() * sizeof(nodes[0]) + blocks.size() * sizeof(blocks[0]); }
};

/// All of a scene: one tree of what stands still, and for each distinct set of key times one tree per key span.
struct Accel {
  Tree<kStaticKeys> still;
  std::vector<Tree<kMovingKeys>> moving;

  size_t memory_bytes() const {
    size_t bytes = still.memory_bytes();
    for (const auto& tree : moving) bytes += tree.memory_bytes();
    return bytes;
  }
  uint32_t depth() const {
    uint32_t deepest = still.depth;
    for (const auto& tree : moving) deepest = deepest < tree.depth ? tree.depth : deepest;
    return deepest;
  }
};

}  // namespace kairos
