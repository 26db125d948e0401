// Builds the topology of an eight-wide tree over moving boxes by a binned surface-area heuristic.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <kairos/tracer.h>

#include "accel/box_lanes.h"
#include "accel/layout.h"

namespace kairos {

/// What the builder asks about triangles that may have several key spans. Windows are those that it makes: the shutter,
/// or parts of it that begin and end at keys of all triangles in them.
class MovingTriangles {
 public:
  virtual ~MovingTriangles() = default;
  /// How many key spans lie inside a window.
  virtual uint32_t spans(uint32_t mesh, TimeRange window) const = 0;
  /// The key of a mesh inside the window that is nearest to its middle; none when nothing lies between its ends.
  virtual std::optional<float> middle_key(uint32_t mesh, TimeRange window) const = 0;
  virtual bool has_key(uint32_t mesh, float time) const = 0;
  virtual bool same_keys(uint32_t mesh, uint32_t other) const = 0;
  /// Sets id and box: one whose faces move linearly over the window and always contain the triangle.
  virtual void set_primitive(TriangleId id, TimeRange window, Primitive& primitive) const = 0;
};

/// A child is a node, or a leaf: a range of WideTree::order. Lanes that are no part of the box hold that and the
/// window, so that a child is one cache line.
class WideChild {
 public:
  void set_node(const BoxLanes& box, TimeRange window, NodeRef node) { set(box, window, node, 0); }
  void set_leaf(const BoxLanes& box, TimeRange window, uint32_t begin, uint32_t count) {
    set(box, window, begin, count);
  }
  /// Where a subtree's nodes and order are moved by so many places.
  void move(uint32_t nodes, uint32_t order) {
    box_.bound[0][3] = std::bit_cast<float>(first() + (is_leaf() ? order : nodes));
  }

  const BoxLanes& box() const { return box_; }
  TimeRange window() const { return {box_.bound[2][3], box_.bound[3][3]}; }
  bool is_leaf() const { return count() != 0; }
  NodeRef node() const { return first(); }    ///< index into WideTree::nodes
  uint32_t begin() const { return first(); }  ///< of a leaf: index into WideTree::order
  uint32_t count() const { return std::bit_cast<uint32_t>(box_.bound[1][3]); }  ///< of a leaf: 1 to kWidth

 private:
  void set(const BoxLanes& box, TimeRange window, uint32_t first, uint32_t count) {
    box_ = box;
    box_.bound[0][3] = std::bit_cast<float>(first);
    box_.bound[1][3] = std::bit_cast<float>(count);
    box_.bound[2][3] = window.begin;
    box_.bound[3][3] = window.end;
  }
  uint32_t first() const { return std::bit_cast<uint32_t>(box_.bound[0][3]); }

  BoxLanes box_;
};

struct WideNode {
  std::array<WideChild, kWidth> child;
  uint32_t child_count, leaf_count;

  WideNode() {}  // NOLINT(modernize-use-equals-default): a kilobyte that need not be zero first
};

struct WideTree {
  std::vector<WideNode> nodes;    ///< nodes[0] is the root; empty when one leaf holds all triangles
  std::vector<TriangleId> order;  ///< triangles leaf by leaf; a leaf for each part of time in which it is there
  uint32_t depth = 0;
};

/// `primitives` are used up. `moving`: also split by velocity. `several_spans`: null when no triangle has more than one
/// key span; otherwise ranges are split in time, too, where that saves more than it costs. Parallel; the result does
/// not depend on the number of threads nor on the instruction set. leaf_size: the most primitives of a leaf, 1 to
/// kWidth.
WideTree build_wide_tree(std::span<Primitive> primitives, bool moving, const MovingTriangles* several_spans = nullptr,
                         uint32_t leaf_size = kWidth);

}  // namespace kairos
