// Traversal in plain double precision: what the vector code is checked against, and what old machines run.
//
// No ordering, no culling by time bins: it visits every node that the ray meets at any time and leaves the rest to the
// resolve step. Slow on purpose; short enough to be read in one go.

#include <array>
#include <optional>

#include "kernels/dispatch.h"
#include "kernels/moving_box_test.h"
#include "kernels/moving_triangle.h"

namespace kairos {

namespace {

/// A box of a node, at its first and last key.
template <int kKeys>
std::optional<BoxInterval> intersect_child(const Node<kKeys>& node, size_t child, const Ray& ray) {
  Vec3d lower[2], upper[2];
  for (size_t key = 0; key < 2; ++key)
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t from = key == 0 ? 0 : kKeys - 1;  // what stands still has one key for both
      lower[key][static_cast<int>(axis)] = node.lower[from][axis][child];
      upper[key][static_cast<int>(axis)] = node.upper[from][axis][child];
    }
  return intersect_moving_box(to_double(ray.origin), to_double(ray.direction), lower, upper);
}

/// Adds what the ray meets of a triangle between two keys at the given shutter times.
void add_triangle(const RayFrame<double>& frame, const std::array<std::array<Vec3f, 3>, 2>& position, uint32_t mesh,
                  uint32_t triangle, float span_begin, float span_end, RayState& state) {
  const FramedTriangle<double> framed = to_frame(frame, position);
  const HitIntervals<double> found = intersect_moving_triangle(framed);
  const auto edges = edge_functions(framed);
  for (size_t i = 0; i < static_cast<size_t>(found.count); ++i)
    add_in_pieces(state, framed, edges, found.hit[i], mesh, triangle, span_begin, span_end);
}

void collect_still(const StillTree& tree, const Ray& ray, RayState& state) {
  const RayFrame<double> frame(ray);
  StackEntry* top = state.stack.data();
  *top++ = {tree.root, 0, 0, 1};
  while (top != state.stack.data()) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) == 0) {
      const auto& node = tree.nodes[ref];
      ++state.counters.nodes;
      for (size_t c = 0; c < node.count; ++c)
        if (intersect_child(node, c, ray)) *top++ = {node.child[c], 0, 0, 1};
      continue;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    state.counters.triangles += block.count;
    for (size_t lane = 0; lane < block.count; ++lane) {
      std::array<std::array<Vec3f, 3>, 2> position;
      for (auto& key : position)
        for (size_t vertex = 0; vertex < 3; ++vertex)
          for (size_t axis = 0; axis < 3; ++axis)
            key[vertex][static_cast<int>(axis)] = block.position[0][vertex][axis][lane];
      add_triangle(frame, position, block.mesh[lane], block.triangle[lane], 0, 1, state);
    }
  }
}

void collect_moving(const MovingTree& tree, const Ray& ray, RayState& state) {
  const RayFrame<double> frame(ray);
  StackEntry* top = state.stack.data();
  *top++ = {tree.root, 0, 0, 1};
  while (top != state.stack.data()) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) == 0) {
      ++state.counters.nodes;
      const auto& node = tree.nodes[ref];
      for (size_t c = 0; c < node.count; ++c)
        if (intersect_child(node, c, ray)) *top++ = {node.child[c], 0, 0, 1};
      continue;
    }
    const MovingBlock& block = tree.blocks[ref & ~kLeafBit];
    for (uint32_t s = 0; s < block.spans; ++s) {
      const Span span(tree, block, s);
      for (size_t lane = 0; lane < block.count; ++lane) {
        const float begin = span.begin.lane[lane], end = span.end.lane[lane];
        if (!(begin < end)) continue;  // a jump takes no time, nor do keys that are repeated
        ++state.counters.triangles;
        state.counters.root_solves += 3;
        add_triangle(frame, span.triangle(lane), block.mesh[lane], block.triangle[lane], begin, end, state);
      }
    }
  }
}

}  // namespace

void collect_hits_scalar(const Accel& accel, const Ray& ray, RayState& state) {
  if (accel.still.root != kNoNode) collect_still(accel.still, ray, state);
  if (accel.moving.root != kNoNode && !state.is_complete()) collect_moving(accel.moving, ray, state);
}

}  // namespace kairos
