#include "accel/accel.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <kairos/error.h>

#include "accel/builder.h"
#include "accel/instances.h"
#include "accel/moving_meshes.h"
#include "accel/sort_by_motion.h"
#include "accel/triangle_bounds.h"
#include "accel/wide_nodes.h"
#include "base/parallel.h"

namespace kairos {

namespace {

constexpr uint32_t kGrain = 16384;  // triangles per piece of a parallel loop

/// The ids of a block's triangles.
template <class Block>
void set_ids(const Leaf& leaf, Block& block) {
  block.count = static_cast<decltype(block.count)>(leaf.triangles.size());
  for (uint32_t slot = 0; slot < kWidth; ++slot) {
    block.mesh[slot] = leaf.in_slot(slot).mesh;
    block.triangle[slot] = leaf.in_slot(slot).triangle;
  }
}

void set_positions(const Mesh& mesh, uint32_t triangle, size_t key, uint32_t slot, float (&position)[3][3][kWidth]) {
  for (size_t vertex = 0; vertex < 3; ++vertex) {
    const Vec3f& from = mesh.positions[key][mesh.triangles[triangle][vertex]];
    for (int axis = 0; axis < 3; ++axis) position[vertex][axis][slot] = from[axis];
  }
}

void build_still(std::span<const Mesh> meshes, const TriangleList& triangles, StillTree& tree) {
  WideTree wide;
  {
    LargeArray<Primitive> primitives(triangles.size());
    parallel_for(triangles.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Mesh& mesh = meshes[triangles[i].mesh];
        const auto bounds = bounds_at(mesh, mesh.triangles[triangles[i].triangle], 0);
        primitives[i].box.bound = {bounds[0], bounds[1], bounds[0], bounds[1]};
        primitives[i].set_id(triangles[i]);
      }
    });
    wide = build_wide_tree(primitives, false);
  }
  const std::vector<Leaf> leaves = set_nodes(wide, tree);
  tree.blocks.resize(leaves.size());
  parallel_for(leaves.size(), kNodeGrain, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      set_ids(leaves[b], tree.blocks[b]);
      for (uint32_t slot = 0; slot < kWidth; ++slot) {
        const TriangleId id = leaves[b].in_slot(slot);
        set_positions(meshes[id.mesh], id.triangle, 0, slot, tree.blocks[b].position[0]);
      }
    }
  });
}

/// Says for each block where its keys and times are, and sets the times: once for all blocks with the same.
void set_times(const KeySets& keys, const std::vector<Leaf>& leaves, MovingTree& tree) {
  using Lane = std::tuple<uint32_t, size_t, size_t>;  // set of keys, first and last
  std::map<std::pair<std::array<Lane, kWidth>, uint32_t>, uint32_t> known;
  uint32_t key_count = 0;
  for (size_t b = 0; b < leaves.size(); ++b) {
    MovingBlock& block = tree.blocks[b];
    std::array<Lane, kWidth> lanes;
    block.spans = 0;
    for (uint32_t slot = 0; slot < kWidth; ++slot) {
      const uint32_t mesh = leaves[b].in_slot(slot).mesh;
      const auto [first, last] = keys.keys_in(mesh, leaves[b].window);
      lanes[slot] = {keys.set_of(mesh), first, last};
      block.spans = std::max(block.spans, static_cast<uint32_t>(last - first));
    }
    block.same_times = std::all_of(lanes.begin(), lanes.end(), [&](const Lane& lane) { return lane == lanes[0]; });
    block.first_key = key_count;
    key_count += block.spans + 1;
    const auto [place, is_new] = known.emplace(std::pair(lanes, block.spans), static_cast<uint32_t>(tree.times.size()));
    block.first_time = place->second;
    if (!is_new) continue;
    for (uint32_t key = 0; key <= block.spans; ++key) {
      Row& row = tree.times.emplace_back();
      for (uint32_t slot = 0; slot < kWidth; ++slot) {
        const auto [set, first, last] = lanes[slot];
        row.lane[slot] = keys.times_of_set(set)[std::min(first + key, last)];
      }
    }
  }
  tree.keys.resize(key_count);
}

void set_windows(const WideTree& wide, MovingTree& tree) {
  tree.windows.resize(wide.nodes.size());
  for (size_t n = 0; n < wide.nodes.size(); ++n) {
    const WideNode& node = wide.nodes[n];
    for (uint32_t slot = 0; slot < kWidth; ++slot) {
      const TimeRange window = node.child[slot < node.child_count ? slot : 0].window();
      tree.windows[n].begin.lane[slot] = window.begin;
      tree.windows[n].end.lane[slot] = window.end;
    }
  }
}

bool has_windows(const WideTree& wide) {
  for (const WideNode& node : wide.nodes)
    for (uint32_t c = 0; c < node.child_count; ++c)
      if (node.child[c].window().begin != 0 || node.child[c].window().end != 1) return true;
  return false;
}

void build_moving(std::span<const Mesh> meshes, const TriangleList& triangles, MovingTree& tree) {
  const KeySets keys(meshes);
  const MovingMeshes moving(meshes, keys);
  WideTree wide;
  {
    LargeArray<Primitive> primitives(triangles.size());
    parallel_for(triangles.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) moving.set_primitive(triangles[i], {}, primitives[i]);
    });
    wide = build_wide_tree(primitives, true, keys.several_spans() ? &moving : nullptr);
  }
  const std::vector<Leaf> leaves = set_nodes(wide, tree);
  if (has_windows(wide)) set_windows(wide, tree);
  tree.blocks.resize(leaves.size());
  set_times(keys, leaves, tree);
  parallel_for(leaves.size(), kNodeGrain, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      MovingBlock& block = tree.blocks[b];
      set_ids(leaves[b], block);
      for (uint32_t slot = 0; slot < kWidth; ++slot) {
        const TriangleId id = leaves[b].in_slot(slot);
        const auto [first, last] = keys.keys_in(id.mesh, leaves[b].window);
        for (uint32_t key = 0; key <= block.spans; ++key)
          set_positions(meshes[id.mesh], id.triangle, std::min(first + key, last), slot,
                        tree.keys[block.first_key + key].position);
      }
    }
  });
}

}  // namespace

Accel build_accel(std::span<const Mesh> meshes, bool moving_meshes_only) {
  uint64_t total = 0;
  for (const Mesh& mesh : meshes) total += mesh.object ? 1 : mesh.triangles.size();
  if (total >= kLeafBit)
    throw Error(ErrorCode::bad_input, "",
                "the scene has " + std::to_string(total) + " triangles; at most 2^31 - 1 can be traced");

  Sorted sorted = sort_by_motion(meshes, moving_meshes_only);
  Accel accel;
  build_still(meshes, sorted.still, accel.still);
  TriangleList().swap(sorted.still);
  build_moving(meshes, sorted.moving, accel.moving);
  TriangleList().swap(sorted.moving);
  build_instances(
      meshes, moving_meshes_only,
      [](const Mesh& object, StillTree& tree) {
        const std::span<const Mesh> one(&object, 1);
        build_still(one, sort_by_motion(one, false).still, tree);
      },
      accel);
  return accel;
}

}  // namespace kairos
