// Memory layout of the accelerator: the one thing that builders and kernels share.
//
// Two eight-wide trees: one of what stands still, one over time of what moves. A moving node holds its children's boxes
// at the two ends of a window of time, between which their faces move linearly; a leaf is one block of up to eight
// triangles with their vertices at all keys inside the leaf's window, each key stored once, so that a kernel reads
// plain vectors and never the meshes. Triangles of one block may have keys at different times. Instances have trees of
// their own, whose leaves refer to their objects' trees.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <kairos/affine_map.h>

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

/// A tree under a motion: an object, placed by an affine map at each key, every vertex going straight in between.
struct Instance {
  uint32_t mesh;
  uint32_t object;           ///< index into Accel::objects
  uint32_t spans;            ///< key spans; 0: it stands still
  uint32_t first_placement;  ///< index into InstanceTree::placements of the first of spans + 1
  uint32_t first_time;       ///< index into InstanceTree::times, likewise; instances share equal ones
};

/// Instances, each a leaf of its own: a NodeRef with kLeafBit is an index into `instances`. Boxes are there for the
/// whole shutter.
template <int kKeys>
struct InstanceTree {
  LargeArray<Node<kKeys>> nodes;
  LargeArray<Instance> instances;
  LargeArray<AffineMap> placements;
  std::vector<float> times;  ///< shutter times of keys; none where all stand still
  NodeRef root = kNoNode;
  uint32_t depth = 0;

  size_t memory_bytes() const {
    return bytes_of(nodes) + bytes_of(instances) + bytes_of(placements) + times.size() * sizeof(float);
  }
};

/// All of a scene.
struct Accel {
  StillTree still;
  MovingTree moving;
  std::vector<StillTree> objects;
  InstanceTree<kStaticKeys> still_instances;
  InstanceTree<kMovingKeys> moving_instances;

  size_t memory_bytes() const {
    size_t bytes =
        still.memory_bytes() + moving.memory_bytes() + still_instances.memory_bytes() + moving_instances.memory_bytes();
    for (const StillTree& object : objects) bytes += object.memory_bytes();
    return bytes;
  }
  /// Nodes on the longest way to a block; what is left of a tree of instances waits while an object is walked.
  uint32_t depth() const {
    uint32_t object_depth = 0;
    for (const StillTree& object : objects) object_depth = std::max(object_depth, object.depth);
    // One level more: of an object that is a single block.
    const uint32_t of_instances = std::max(still_instances.depth, moving_instances.depth) + object_depth + 1;
    return std::max({still.depth, moving.depth, objects.empty() ? 0 : of_instances});
  }
};

}  // namespace kairos
