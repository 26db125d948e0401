// Memory layout of the accelerator: the one thing that builders and kernels share.
//
// Two eight-wide trees: one of what stands still, one over time of what moves. A moving node holds its children's boxes
// at the two ends of a window of time, between which their faces move linearly; a leaf is one block of up to eight
// triangles with their vertices at all keys inside the leaf's window, each key stored once, so that a kernel reads
// plain vectors and never the meshes. Triangles of one block may have keys at different times.
#pragma once

#include <cstddef>
#include <cstdint>

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

template <class T>
size_t bytes_of(const LargeArray<T>& array) {
  return array.size() * sizeof(T);
}

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

/// What stands still.
struct StillTree {
  LargeArray<Node<kStaticKeys>> nodes;
  LargeArray<TriangleBlock<kStaticKeys>> blocks;
  NodeRef root = kNoNode;
  uint32_t depth = 0;  ///< nodes on the longest way from the root to a block

  size_t memory_bytes() const { return bytes_of(nodes) + bytes_of(blocks); }
};

/// One number per child of a node or triangle of a block.
struct alignas(32) Row {
  float lane[kWidth];
};

/// When a node's children are there: their boxes are those at these two shutter times.
struct ChildWindows {
  Row begin, end;
};

/// The vertices of a block's triangles at one of their keys.
struct alignas(32) BlockKey {
  float position[3][3][kWidth];  ///< [vertex][axis][triangle]
};

/// Up to eight moving triangles over the window of a leaf.
struct alignas(16) MovingBlock {
  uint32_t mesh[kWidth];
  uint32_t triangle[kWidth];
  uint16_t count;       ///< triangles 0 to count - 1 exist; the other slots repeat triangle 0
  bool same_times;      ///< all of the triangles have their keys at the same times
  uint32_t spans;       ///< key spans, the most that any of the triangles has there; others repeat their last key
  uint32_t first_key;   ///< index into MovingTree::keys of the first of spans + 1
  uint32_t first_time;  ///< index into MovingTree::times of the first of spans + 1
};

/// What moves, over the whole shutter.
struct MovingTree {
  LargeArray<Node<kMovingKeys>> nodes;
  LargeArray<ChildWindows> windows;  ///< [node]; none when all children are there for the whole shutter
  LargeArray<MovingBlock> blocks;
  LargeArray<BlockKey> keys;
  LargeArray<Row> times;  ///< shutter times of keys, per triangle: ascending in each lane. Blocks share equal ones
  NodeRef root = kNoNode;
  uint32_t depth = 0;

  size_t memory_bytes() const {
    return bytes_of(nodes) + bytes_of(windows) + bytes_of(blocks) + bytes_of(keys) + bytes_of(times);
  }
};

/// All of a scene.
struct Accel {
  StillTree still;
  MovingTree moving;

  size_t memory_bytes() const { return still.memory_bytes() + moving.memory_bytes(); }
  uint32_t depth() const { return still.depth < moving.depth ? moving.depth : still.depth; }
};

}  // namespace kairos
