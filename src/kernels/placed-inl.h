// Where the nodes and triangles of trees come from: the tree itself, or an object's tree that an instance places.
// Compiled once per instruction set; see trace_simd.cpp.
//
// A vertex of an instance goes straight from where the map of one key places it to where the next one does. So the
// object's triangles, placed at both keys, are moving triangles like any other, and a box whose bounds are placed at
// both keys holds them all along. Both are placed when they are visited, in the order of operations of
// AffineMap::point, so that an instance gives the bits of an expanded copy. docs/method.md, "Instances".

#if defined(KAIROS_PLACED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KAIROS_PLACED_INL_H
#undef KAIROS_PLACED_INL_H
#else
#define KAIROS_PLACED_INL_H
#endif

#include <algorithm>
#include <cstring>

#include <hwy/highway.h>

#include "accel/layout.h"
#include "kernels/node_test-inl.h"
#include "kernels/ray_state.h"

/// For lambdas, where HWY_INLINE does not fit.
#ifndef KAIROS_INLINE
#define KAIROS_INLINE HWY_ATTR __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace kairos {
namespace HWY_NAMESPACE {

/// The boxes of a node's children, placed.
HWY_INLINE void PlaceBoxes(const Node<kStaticKeys>& from, const AffineMap& map, float (&lower)[3][kWidth],
                           float (&upper)[3][kWidth]) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= from.count) break;
    V low[3], high[3];
    for (size_t k = 0; k < 3; ++k) {
      low[k] = hn::Load(d, from.lower[0][k] + lane);
      high[k] = hn::Load(d, from.upper[0][k] + lane);
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      const Vec4f& row = map.rows[axis];
      const float factor[3] = {row.x, row.y, row.z};
      V least{}, most{};
      for (size_t k = 0; k < 3; ++k) {
        const V f = hn::Set(d, factor[k]);
        const V a = hn::Mul(f, low[k]), b = hn::Mul(f, high[k]);
        least = k == 0 ? hn::Min(a, b) : hn::Add(least, hn::Min(a, b));
        most = k == 0 ? hn::Max(a, b) : hn::Add(most, hn::Max(a, b));
      }
      const V shift = hn::Set(d, row.w);
      hn::Store(hn::Add(least, shift), d, lower[axis] + lane);
      hn::Store(hn::Add(most, shift), d, upper[axis] + lane);
    }
  }
}

/// The vertices of a block, placed.
HWY_INLINE void PlaceVertices(const TriangleBlock<kStaticKeys>& from, const AffineMap& map,
                              float (&position)[3][3][kWidth]) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  for (size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    if (lane >= from.count) break;
    for (size_t vertex = 0; vertex < 3; ++vertex) {
      const auto& own = from.position[0][vertex];
      const V x = hn::Load(d, own[0] + lane), y = hn::Load(d, own[1] + lane), z = hn::Load(d, own[2] + lane);
      for (size_t axis = 0; axis < 3; ++axis) {
        const Vec4f& row = map.rows[axis];
        const V xy = hn::Add(hn::Mul(hn::Set(d, row.x), x), hn::Mul(hn::Set(d, row.y), y));
        hn::Store(hn::Add(hn::Add(xy, hn::Mul(hn::Set(d, row.z), z)), hn::Set(d, row.w)), d,
                  position[vertex][axis] + lane);
      }
    }
  }
}

template <class Block>
HWY_INLINE void NameTriangles(const TriangleBlock<kStaticKeys>& from, uint32_t mesh, Block& to) {
  std::fill_n(to.mesh, kWidth, mesh);
  std::memcpy(to.triangle, from.triangle, sizeof(from.triangle));
  to.count = static_cast<decltype(to.count)>(from.count);
}

/// A tree of what stands still.
class StillSource {
 public:
  explicit StillSource(const StillTree& tree) : tree_(tree) {}
  const Node<kStaticKeys>& NodeAt(NodeRef ref) { return tree_.nodes[ref]; }
  const TriangleBlock<kStaticKeys>& BlockAt(NodeRef ref) { return tree_.blocks[ref & ~kLeafBit]; }

 private:
  const StillTree& tree_;
};

/// An instance that stands still.
class PlacedStillSource {
 public:
  PlacedStillSource(const Accel& accel, const Instance& instance)
      : object_(accel.objects[instance.object]),
        map_(accel.still_instances.placements[instance.first_placement]),
        mesh_(instance.mesh) {}
  NodeRef Root() const { return object_.root; }

  HWY_INLINE const Node<kStaticKeys>& NodeAt(NodeRef ref) {
    const Node<kStaticKeys>& own = object_.nodes[ref];
    PlaceBoxes(own, map_, node_.lower[0], node_.upper[0]);
    std::memcpy(node_.child, own.child, sizeof(own.child));
    node_.count = own.count;
    return node_;
  }
  HWY_INLINE const TriangleBlock<kStaticKeys>& BlockAt(NodeRef ref) {
    const TriangleBlock<kStaticKeys>& own = object_.blocks[ref & ~kLeafBit];
    PlaceVertices(own, map_, block_.position[0]);
    NameTriangles(own, mesh_, block_);
    return block_;
  }

 private:
  const StillTree& object_;
  const AffineMap& map_;
  uint32_t mesh_;
  Node<kStaticKeys> node_;
  TriangleBlock<kStaticKeys> block_;
};

/// A tree over time of what moves.
class MovingSource {
 public:
  explicit MovingSource(const MovingTree& tree) : tree_(tree) {}
  const Node<kMovingKeys>& NodeAt(NodeRef ref) { return tree_.nodes[ref]; }
  const ChildWindows* WindowsAt(NodeRef ref) const { return tree_.windows.empty() ? nullptr : &tree_.windows[ref]; }

  /// Calls visit(block, span, lanes, follows) for each key span of a block that [begin, end] touches; `follows`: the
  /// last one was the span before. What is visited should be marked KAIROS_INLINE: called as a function, it costs
  /// packets of four a twentieth of their time.
  template <class Visit>
  HWY_INLINE void ForEachSpan(NodeRef ref, float begin, float end, const Visit& visit) {
    const MovingBlock& block = tree_.blocks[ref & ~kLeafBit];
    const Row* times = &tree_.times[block.first_time];
    bool follows = false;
    for (uint32_t s = 0; s < block.spans; ++s) {
      const uint32_t lanes = LanesInSpan(block, times + s, begin, end);
      if (lanes != 0) visit(block, Span(tree_, block, s), lanes, follows);
      follows = lanes != 0;
    }
  }

 private:
  const MovingTree& tree_;
};

/// An instance between two of its keys.
class PlacedMovingSource {
 public:
  PlacedMovingSource(const Accel& accel, const Instance& instance)
      : object_(accel.objects[instance.object]),
        map_(&accel.moving_instances.placements[instance.first_placement]),
        times_(&accel.moving_instances.times[instance.first_time]),
        spans_(instance.spans),
        mesh_(instance.mesh) {
    block_.spans = 1;
  }
  NodeRef Root() const { return object_.root; }
  uint32_t Spans() const { return spans_; }

  /// Goes to a key span. False where [begin, end] does not touch it, or it takes no time. Cuts both to it.
  HWY_INLINE bool EnterSpan(uint32_t span, float& begin, float& end) {
    span_ = span;
    const float from = times_[span], to = times_[span + 1];
    if (!(from <= end && to >= begin && from < to)) return false;
    std::fill_n(windows_.begin.lane, kWidth, from);
    std::fill_n(windows_.end.lane, kWidth, to);
    begin = std::max(begin, from);
    end = std::min(end, to);
    return true;
  }

  HWY_INLINE const Node<kMovingKeys>& NodeAt(NodeRef ref) {
    const Node<kStaticKeys>& own = object_.nodes[ref];
    for (size_t key = 0; key < 2; ++key) PlaceBoxes(own, map_[span_ + key], node_.lower[key], node_.upper[key]);
    std::memcpy(node_.child, own.child, sizeof(own.child));
    node_.count = own.count;
    return node_;
  }
  const ChildWindows* WindowsAt(NodeRef) const { return spans_ == 1 ? nullptr : &windows_; }

  template <class Visit>
  HWY_INLINE void ForEachSpan(NodeRef ref, float, float, const Visit& visit) {
    const TriangleBlock<kStaticKeys>& own = object_.blocks[ref & ~kLeafBit];
    for (size_t key = 0; key < 2; ++key) PlaceVertices(own, map_[span_ + key], keys_[key].position);
    NameTriangles(own, mesh_, block_);
    visit(block_, Span(keys_[0], keys_[1], windows_.begin, windows_.end), (2u << (own.count - 1)) - 1, false);
  }

 private:
  const StillTree& object_;
  const AffineMap* map_;  // [key]
  const float* times_;    // [key]
  uint32_t spans_, mesh_, span_ = 0;
  ChildWindows windows_;
  Node<kMovingKeys> node_;
  MovingBlock block_;
  BlockKey keys_[2];
};

/// Walks a tree of instances: enter(instance, entry, top) for each that is met, with the stack's place from which on it
/// may be used; skip(entry) says what need not be visited, and may cut the entry's time.
template <int kKeys, class Slabs, class Skip, class Enter>
HWY_INLINE void WalkInstances(const InstanceTree<kKeys>& tree, const Slabs& slabs, StackEntry* bottom,
                              TraceCounters& counters, const Skip& skip, const Enter& enter) {
  StackEntry* top = bottom;
  *top++ = {tree.root, 0, 0, 1};
  NodeHits node_hits;
  while (top != bottom) {
    StackEntry entry = *--top;
    if (skip(entry)) continue;
    if ((entry.node & kLeafBit) != 0) {
      if (!enter(tree.instances[entry.node & ~kLeafBit], entry, top)) return;
      continue;
    }
    const auto& node = tree.nodes[entry.node];
    ++counters.nodes;
    if constexpr (kKeys == kMovingKeys)
      TestNode(node, nullptr, slabs, entry.begin, entry.end, node_hits);
    else
      TestNode(node, slabs, node_hits);
    top = PushChildren(node.child, node_hits, kKeys == kMovingKeys, top);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kairos
HWY_AFTER_NAMESPACE();

#endif
