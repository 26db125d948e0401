// Traversal in plain double precision: what the vector code is checked against, and what old machines run.
//
// No ordering, no culling by time bins: it visits every node that the ray meets at any time and leaves the rest to the
// resolve step. Slow on purpose; short enough to be read in one go.

#include <array>

#include "kernels/dispatch.h"
#include "kernels/moving_box_test.h"
#include "kernels/moving_triangle.h"

namespace kairos {

namespace {

template <int kKeys>
void collect(const Tree<kKeys>& tree, const Ray& ray, RayState& state) {
  constexpr size_t kLast = kKeys - 1;  // key at the end of the span; static trees have one key for both
  const RayFrame<double> frame(ray);
  const Vec3d origin = to_double(ray.origin), direction = to_double(ray.direction);
  StackEntry* top = state.stack.data();
  *top++ = {tree.root, 0, 0, 1};
  while (top != state.stack.data()) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) == 0) {
      const auto& node = tree.nodes[ref];
      ++state.counters.nodes;
      for (size_t c = 0; c < node.count; ++c) {
        Vec3d lower[2], upper[2];
        for (size_t key = 0; key < 2; ++key)
          for (size_t axis = 0; axis < 3; ++axis) {
            lower[key][static_cast<int>(axis)] = node.lower[key == 0 ? 0 : kLast][axis][c];
            upper[key][static_cast<int>(axis)] = node.upper[key == 0 ? 0 : kLast][axis][c];
          }
        if (const auto box = intersect_moving_box(origin, direction, lower, upper))
          *top++ = {node.child[c], static_cast<float>(box->dist), static_cast<float>(box->begin),
                    static_cast<float>(box->end)};
      }
      continue;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    state.counters.triangles += block.count;
    for (size_t lane = 0; lane < block.count; ++lane) {
      std::array<std::array<Vec3f, 3>, 2> position;
      for (size_t key = 0; key < 2; ++key)
        for (size_t vertex = 0; vertex < 3; ++vertex)
          for (int axis = 0; axis < 3; ++axis)
            position[key][vertex][axis] = block.position[key == 0 ? 0 : kLast][vertex][axis][lane];
      const FramedTriangle<double> framed = to_frame(frame, position);
      const HitIntervals<double> found = intersect_moving_triangle(framed);
      state.counters.root_solves += kKeys == kMovingKeys ? 3 : 0;
      const auto edges = edge_functions(framed);
      for (size_t i = 0; i < static_cast<size_t>(found.count); ++i)
        add_in_pieces(state, framed, edges, found.hit[i], block.mesh[lane], block.triangle[lane], tree.time_begin,
                      tree.time_end);
    }
  }
}

}  // namespace

void collect_hits_scalar(const Accel& accel, const Ray& ray, RayState& state) {
  if (accel.still.root != kNoNode) collect(accel.still, ray, state);
  for (const auto& tree : accel.moving) {
    if (state.is_complete()) return;
    collect(tree, ray, state);
  }
}

}  // namespace kairos
