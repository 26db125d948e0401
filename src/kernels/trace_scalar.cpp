// Traversal in plain double precision: what the vector code is checked against, and what old machines run.
//
// No ordering, no culling by time bins: it visits every node that the ray meets at any time and leaves the rest to the
// resolve step. Slow on purpose; short enough to be read in one go.

#include <algorithm>
#include <array>
#include <optional>

#include "accel/placed_box.h"
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

/// A node of an object, its boxes placed by the maps of kKeys keys.
template <int kKeys>
Node<kKeys> placed(const Node<kStaticKeys>& node, const AffineMap* map) {
  Node<kKeys> result;
  std::copy_n(node.child, kWidth, result.child);
  result.count = node.count;
  for (size_t c = 0; c < node.count; ++c) {
    const float low[3] = {node.lower[0][0][c], node.lower[0][1][c], node.lower[0][2][c]};
    const float high[3] = {node.upper[0][0][c], node.upper[0][1][c], node.upper[0][2][c]};
    for (size_t key = 0; key < static_cast<size_t>(kKeys); ++key)
      for (size_t axis = 0; axis < 3; ++axis) {
        const PlacedExtent extent(map[key], axis, low, high);
        result.lower[key][axis][c] = extent.lower;
        result.upper[key][axis][c] = extent.upper;
      }
  }
  return result;
}

/// The corners of a block's triangle, placed by a map unless it is null.
std::array<Vec3f, 3> placed(const TriangleBlock<kStaticKeys>& block, size_t lane, const AffineMap* map) {
  std::array<Vec3f, 3> corners;
  for (size_t vertex = 0; vertex < 3; ++vertex) {
    const auto& own = block.position[0][vertex];
    const Vec3f corner{own[0][lane], own[1][lane], own[2][lane]};
    corners[vertex] = map != nullptr ? map->point(corner) : corner;
  }
  return corners;
}

/// Adds what the ray meets of a triangle between two keys at the given shutter times.
void add_triangle(const RayFrame<double>& frame, const std::array<std::array<Vec3f, 3>, 2>& position, uint32_t mesh,
                  uint32_t triangle, float span_begin, float span_end, RayState& state) {
  const FramedTriangle<double> framed = to_frame(frame, position);
  const HitIntervals<double> found = intersect_moving_triangle(framed);
  const auto edges = edge_functions(framed);
  for (size_t i = 0; i < static_cast<size_t>(found.count); ++i)
    add_in_pieces(state, framed, edges, found.hit[i], mesh, triangle, span_begin, span_end,
                  [&](const Segment& piece) { state.add(piece); });
}

/// Adds what the ray meets of what stands still: of a tree, or (map given) of an object that is placed.
void collect_still(const StillTree& tree, const AffineMap* map, uint32_t instance_mesh, const Ray& ray, RayState& state,
                   StackEntry* bottom) {
  const RayFrame<double> frame(ray);
  StackEntry* top = bottom;
  *top++ = {tree.root, 0, 0, 1};
  while (top != bottom) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) == 0) {
      const auto& node = map != nullptr ? placed<kStaticKeys>(tree.nodes[ref], map) : tree.nodes[ref];
      ++state.counters.nodes;
      for (size_t c = 0; c < node.count; ++c)
        if (intersect_child(node, c, ray)) *top++ = {node.child[c], 0, 0, 1};
      continue;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    state.counters.triangles += block.count;
    for (size_t lane = 0; lane < block.count; ++lane) {
      const std::array<Vec3f, 3> corners = placed(block, lane, map);
      add_triangle(frame, {corners, corners}, map != nullptr ? instance_mesh : block.mesh[lane], block.triangle[lane],
                   0, 1, state);
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

/// An object that is placed at the begin of a key span and at its end, `map` and the one after it.
void collect_placed(const StillTree& tree, const AffineMap* map, uint32_t mesh, float begin, float end, const Ray& ray,
                    RayState& state, StackEntry* bottom) {
  const RayFrame<double> frame(ray);
  StackEntry* top = bottom;
  *top++ = {tree.root, 0, 0, 1};
  while (top != bottom) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) == 0) {
      ++state.counters.nodes;
      const auto node = placed<kMovingKeys>(tree.nodes[ref], map);
      for (size_t c = 0; c < node.count; ++c)
        if (intersect_child(node, c, ray)) *top++ = {node.child[c], 0, 0, 1};
      continue;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    for (size_t lane = 0; lane < block.count; ++lane) {
      ++state.counters.triangles;
      state.counters.root_solves += 3;
      add_triangle(frame, {placed(block, lane, map), placed(block, lane, map + 1)}, mesh, block.triangle[lane], begin,
                   end, state);
    }
  }
}

/// Calls enter(instance, top) for each instance whose box the ray meets.
template <int kKeys, class Enter>
void walk_instances(const InstanceTree<kKeys>& tree, const Ray& ray, RayState& state, const Enter& enter) {
  StackEntry* const bottom = state.stack.data();
  StackEntry* top = bottom;
  *top++ = {tree.root, 0, 0, 1};
  while (top != bottom) {
    const NodeRef ref = (--top)->node;
    if ((ref & kLeafBit) != 0) {
      enter(tree.instances[ref & ~kLeafBit], top);
      continue;
    }
    ++state.counters.nodes;
    const auto& node = tree.nodes[ref];
    for (size_t c = 0; c < node.count; ++c)
      if (intersect_child(node, c, ray)) *top++ = {node.child[c], 0, 0, 1};
  }
}

void collect_instances(const Accel& accel, const Ray& ray, RayState& state) {
  if (const auto& still = accel.still_instances; still.root != kNoNode)
    walk_instances(still, ray, state, [&](const Instance& instance, StackEntry* top) {
      collect_still(accel.objects[instance.object], &still.placements[instance.first_placement], instance.mesh, ray,
                    state, top);
    });
  if (const auto& moving = accel.moving_instances; moving.root != kNoNode)
    walk_instances(moving, ray, state, [&](const Instance& instance, StackEntry* top) {
      for (uint32_t span = 0; span < instance.spans; ++span) {
        const float begin = moving.times[instance.first_time + span],
                    end = moving.times[instance.first_time + span + 1];
        if (begin < end)
          collect_placed(accel.objects[instance.object], &moving.placements[instance.first_placement + span],
                         instance.mesh, begin, end, ray, state, top);
      }
    });
}

}  // namespace

void collect_hits_scalar(const Accel& accel, const Ray& ray, RayState& state) {
  if (accel.still.root != kNoNode) collect_still(accel.still, nullptr, 0, ray, state, state.stack.data());
  if (accel.moving.root != kNoNode && !state.is_complete()) collect_moving(accel.moving, ray, state);
  if (!state.is_complete()) collect_instances(accel, ray, state);
}

}  // namespace kairos
