#include "accel/accel.h"

#include <algorithm>
#include <map>

#include <kairos/error.h>

#include "accel/builder.h"
#include "base/parallel.h"

namespace kairos {

namespace {

constexpr size_t kGrain = 16384;

/// One key span of a group of meshes that share their key times.
struct KeySpan {
  size_t first_key;
  float time_begin, time_end;
};

bool is_still(const Mesh& mesh, const Triangle& triangle) {
  for (size_t key = 1; key < mesh.key_count(); ++key)
    for (uint32_t v : triangle)
      if (mesh.positions[key][v] != mesh.positions[0][v]) return false;
  return true;
}

/// Which triangles go where: lists of (mesh, triangle).
struct TriangleId {
  uint32_t mesh, triangle;
};

const Vec3f& corner(std::span<const Mesh> meshes, const Primitive& p, size_t key, size_t vertex) {
  const Mesh& mesh = meshes[p.mesh];
  return mesh.positions[key][mesh.triangles[p.triangle][vertex]];
}

/// Copies the boxes and vertices of a finished topology into the layout that the kernels read.
template <int kKeys>
void pack(std::span<const Mesh> meshes, std::span<const Primitive> primitives, const WideTree& wide, size_t first_key,
          Tree<kKeys>& tree) {
  // Leaves are numbered in the order of their nodes, so that neighbours in the tree are neighbours in memory.
  struct Leaf {
    uint32_t begin, count;
  };
  std::vector<Leaf> leaves;
  const auto add_leaf = [&](uint32_t begin, uint32_t count) {
    leaves.push_back({begin, count});
    return kLeafBit | static_cast<NodeRef>(leaves.size() - 1);
  };
  tree.depth = wide.depth;
  tree.nodes.resize(wide.nodes.size());
  if (wide.nodes.empty())
    tree.root = primitives.empty() ? kNoNode : add_leaf(0, static_cast<uint32_t>(primitives.size()));
  else
    tree.root = 0;
  for (size_t n = 0; n < wide.nodes.size(); ++n) {
    const WideNode& from = wide.nodes[n];
    Node<kKeys>& to = tree.nodes[n];
    to.count = from.child_count;
    for (uint32_t slot = 0; slot < kWidth; ++slot) {
      const WideChild& child = from.child[slot < from.child_count ? slot : 0];
      for (int key = 0; key < kKeys; ++key)
        for (int axis = 0; axis < 3; ++axis) {
          to.lower[key][axis][slot] = child.box.lower(key, axis);
          to.upper[key][axis][slot] = child.box.upper(key, axis);
        }
      to.child[slot] = slot >= from.child_count ? kNoNode
                       : child.node != kNoNode  ? child.node
                                                : add_leaf(child.begin, child.count);
    }
  }
  tree.blocks.resize(leaves.size());
  parallel_for(leaves.size(), kGrain / kWidth, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      TriangleBlock<kKeys>& block = tree.blocks[b];
      block.count = leaves[b].count;
      for (uint32_t slot = 0; slot < kWidth; ++slot) {
        const Primitive& p = primitives[leaves[b].begin + (slot < block.count ? slot : 0)];
        block.mesh[slot] = p.mesh;
        block.triangle[slot] = p.triangle;
        for (size_t key = 0; key < kKeys; ++key)
          for (size_t vertex = 0; vertex < 3; ++vertex)
            for (int axis = 0; axis < 3; ++axis)
              block.position[key][vertex][axis][slot] = corner(meshes, p, first_key + key, vertex)[axis];
      }
    }
  });
}

template <int kKeys>
void build_tree(std::span<const Mesh> meshes, const std::vector<TriangleId>& triangles, size_t first_key,
                Tree<kKeys>& tree) {
  std::vector<Primitive> primitives(triangles.size());
  parallel_for(triangles.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Primitive& p = primitives[i];
      p.mesh = triangles[i].mesh;
      p.triangle = triangles[i].triangle;
      p.box = MovingBox::empty();
      for (size_t key = 0; key < 2; ++key)
        for (size_t vertex = 0; vertex < 3; ++vertex)
          p.box.include(static_cast<int>(key), corner(meshes, p, first_key + (key < kKeys ? key : 0), vertex));
    }
  });
  const WideTree wide = build_wide_tree(primitives, kKeys == kMovingKeys);
  pack(meshes, primitives, wide, first_key, tree);
}

}  // namespace

Accel build_accel(std::span<const Mesh> meshes, bool moving_meshes_only) {
  uint64_t total = 0;
  for (const Mesh& mesh : meshes) total += mesh.triangles.size();
  if (total >= kLeafBit)
    throw Error(ErrorCode::bad_input, "",
                "the scene has " + std::to_string(total) + " triangles; at most 2^31 - 1 can be traced");

  std::vector<TriangleId> still;
  std::map<std::vector<float>, std::vector<TriangleId>> moving;  // by key times
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    if (moving_meshes_only && mesh.is_static()) continue;
    const uint32_t count = static_cast<uint32_t>(mesh.triangles.size());
    std::vector<TriangleId>* group = mesh.is_static() ? nullptr : &moving[mesh.key_times];
    for (uint32_t f = 0; f < count; ++f)
      (group == nullptr || is_still(mesh, mesh.triangles[f]) ? still : *group).push_back({m, f});
  }

  Accel accel;
  build_tree(meshes, still, 0, accel.still);
  std::vector<TriangleId>().swap(still);
  for (auto& [times, triangles] : moving) {
    if (triangles.empty()) continue;
    for (size_t key = 0; key + 1 < times.size(); ++key) {
      if (times[key] == times[key + 1]) continue;  // a jump takes no time
      Tree<kMovingKeys> tree;
      tree.time_begin = times[key];
      tree.time_end = times[key + 1];
      build_tree(meshes, triangles, key, tree);
      accel.moving.push_back(std::move(tree));
    }
    std::vector<TriangleId>().swap(triangles);
  }
  return accel;
}

}  // namespace kairos
