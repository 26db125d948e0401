#include "accel/accel.h"

#include <algorithm>
#include <map>

#include <kairos/error.h>

#include "accel/builder.h"
#include "base/parallel.h"

namespace kairos {

namespace {

/// Triangles, and nodes with the blocks below them, per piece of a parallel loop.
constexpr uint32_t kGrain = 16384, kNodeGrain = 256;

bool is_still(const Mesh& mesh, const Triangle& triangle) {
  for (size_t key = 1; key < mesh.key_count(); ++key)
    for (uint32_t v : triangle)
      if (mesh.positions[key][v] != mesh.positions[0][v]) return false;
  return true;
}

/// Triangles of one tree, or of one tree per key span.
using TriangleList = LargeArray<TriangleId>;

struct Sorted {
  TriangleList still;
  std::map<std::vector<float>, TriangleList> moving;  // by key times
};

/// Sorts triangles into lists, in which they keep their order.
Sorted sort_by_motion(std::span<const Mesh> meshes, bool moving_meshes_only) {
  struct Piece {
    uint32_t mesh, begin, end;
    TriangleList* moving;  // nullptr for a mesh that does not
    uint32_t still_count, still_offset, moving_offset;
  };
  Sorted sorted;
  std::vector<Piece> pieces;
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    if (moving_meshes_only && mesh.is_static()) continue;
    const uint32_t count = static_cast<uint32_t>(mesh.triangles.size());
    TriangleList* const moving = mesh.is_static() ? nullptr : &sorted.moving[mesh.key_times];
    for (uint64_t begin = 0; begin < count; begin += kGrain)
      pieces.push_back({m, static_cast<uint32_t>(begin),
                        static_cast<uint32_t>(std::min<uint64_t>(count, begin + kGrain)), moving, 0, 0, 0});
  }
  const auto each_piece = [&](const auto& body) {
    parallel_for(pieces.size(), 1, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) body(pieces[p], meshes[pieces[p].mesh]);
    });
  };
  each_piece([](Piece& piece, const Mesh& mesh) {
    if (piece.moving == nullptr) {
      piece.still_count = piece.end - piece.begin;
      return;
    }
    for (uint32_t f = piece.begin; f < piece.end; ++f) piece.still_count += is_still(mesh, mesh.triangles[f]) ? 1 : 0;
  });
  std::map<TriangleList*, uint32_t> moving_count;
  uint32_t still_count = 0;
  for (Piece& piece : pieces) {
    piece.still_offset = still_count;
    still_count += piece.still_count;
    if (piece.moving == nullptr) continue;
    uint32_t& count = moving_count[piece.moving];
    piece.moving_offset = count;
    count += piece.end - piece.begin - piece.still_count;
  }
  sorted.still.resize(still_count);
  for (const auto& [list, count] : moving_count) list->resize(count);
  each_piece([&](const Piece& piece, const Mesh& mesh) {
    TriangleId* still = sorted.still.data() + piece.still_offset;
    TriangleId* moving = piece.moving == nullptr ? nullptr : piece.moving->data() + piece.moving_offset;
    for (uint32_t f = piece.begin; f < piece.end; ++f)
      (moving == nullptr || is_still(mesh, mesh.triangles[f]) ? *still++ : *moving++) = {piece.mesh, f};
  });
  return sorted;
}

/// Where a mesh's vertices are at the keys of a tree.
template <int kKeys>
struct TreeMesh {
  const Triangle* triangles;
  std::array<const Vec3f*, kKeys> positions;
};

template <int kKeys>
std::vector<TreeMesh<kKeys>> meshes_of_tree(std::span<const Mesh> meshes, size_t first_key) {
  std::vector<TreeMesh<kKeys>> views(meshes.size());
  for (size_t m = 0; m < meshes.size(); ++m) {
    views[m].triangles = meshes[m].triangles.data();
    for (size_t key = 0; key < kKeys; ++key)  // meshes with fewer keys have no triangles in this tree
      if (first_key + key < meshes[m].key_count())
        views[m].positions[key] = meshes[m].positions[first_key + key].data();
  }
  return views;
}

template <int kKeys>
void set_primitive(const TreeMesh<kKeys>& mesh, TriangleId id, Primitive& primitive) {
  const Triangle& triangle = mesh.triangles[id.triangle];
  for (size_t key = 0; key < 2; ++key) {
    const Vec3f* positions = mesh.positions[key < kKeys ? key : 0];
    const Vec3f a = positions[triangle[0]], b = positions[triangle[1]], c = positions[triangle[2]];
    for (int axis = 0; axis < 3; ++axis) {
      primitive.box.bound[2 * key][axis] = std::min(std::min(a[axis], b[axis]), c[axis]);
      primitive.box.bound[2 * key + 1][axis] = -std::max(std::max(a[axis], b[axis]), c[axis]);
    }
  }
  primitive.set_id(id);
}

template <int kKeys>
void set_block(std::span<const TreeMesh<kKeys>> meshes, std::span<const TriangleId> ids, TriangleBlock<kKeys>& block) {
  block.count = static_cast<uint32_t>(ids.size());
  for (uint32_t slot = 0; slot < kWidth; ++slot) {
    const TriangleId id = ids[slot < block.count ? slot : 0];
    block.mesh[slot] = id.mesh;
    block.triangle[slot] = id.triangle;
    const TreeMesh<kKeys>& mesh = meshes[id.mesh];
    const Triangle& triangle = mesh.triangles[id.triangle];
    for (size_t key = 0; key < kKeys; ++key)
      for (size_t vertex = 0; vertex < 3; ++vertex) {
        const Vec3f& position = mesh.positions[key][triangle[vertex]];
        for (int axis = 0; axis < 3; ++axis) block.position[key][vertex][axis][slot] = position[axis];
      }
  }
}

/// Boxes and children of a node; its leaves are numbered from `first_leaf` on.
template <int kKeys>
void set_node(const WideNode& from, uint32_t first_leaf, Node<kKeys>& to) {
  to.count = from.child_count;
  for (uint32_t slot = 0; slot < kWidth; ++slot) {
    const WideChild& child = from.child[slot < from.child_count ? slot : 0];
    for (int key = 0; key < kKeys; ++key)
      for (int axis = 0; axis < 3; ++axis) {
        to.lower[key][axis][slot] = child.box().lower(key, axis);
        to.upper[key][axis][slot] = child.box().upper(key, axis);
      }
    to.child[slot] = slot >= from.child_count ? kNoNode : child.is_leaf() ? kLeafBit | first_leaf++ : child.node();
  }
}

/// Copies the boxes and vertices of a finished topology into the layout that the kernels read. Leaves are numbered in
/// the order of their nodes, so that neighbours in the tree are neighbours in memory.
template <int kKeys>
void pack(std::span<const TreeMesh<kKeys>> meshes, std::span<const TriangleId> order, const WideTree& wide,
          Tree<kKeys>& tree) {
  tree.depth = wide.depth;
  if (wide.nodes.empty()) {
    if (order.empty()) return;
    tree.root = kLeafBit;
    tree.blocks.resize(1);
    set_block(meshes, order, tree.blocks[0]);
    return;
  }
  tree.root = 0;
  std::vector<uint32_t> first_leaf(wide.nodes.size());
  uint32_t leaves = 0;
  for (size_t n = 0; n < wide.nodes.size(); ++n) {
    first_leaf[n] = leaves;
    leaves += wide.nodes[n].leaf_count;
  }
  tree.nodes.resize(wide.nodes.size());
  tree.blocks.resize(leaves);
  parallel_for(wide.nodes.size(), kNodeGrain, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const WideNode& node = wide.nodes[n];
      set_node(node, first_leaf[n], tree.nodes[n]);
      uint32_t leaf = first_leaf[n];
      for (uint32_t c = 0; c < node.child_count; ++c)
        if (node.child[c].is_leaf())
          set_block(meshes, order.subspan(node.child[c].begin(), node.child[c].count()), tree.blocks[leaf++]);
    }
  });
}

template <int kKeys>
void build_tree(std::span<const Mesh> meshes, const TriangleList& triangles, size_t first_key, Tree<kKeys>& tree) {
  const std::vector<TreeMesh<kKeys>> views = meshes_of_tree<kKeys>(meshes, first_key);
  TriangleList order(triangles.size());
  WideTree wide;
  {
    LargeArray<Primitive> primitives(triangles.size());
    parallel_for(triangles.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) set_primitive(views[triangles[i].mesh], triangles[i], primitives[i]);
    });
    wide = build_wide_tree(primitives, kKeys == kMovingKeys, order);
  }
  pack<kKeys>(views, order, wide, tree);
}

}  // namespace

Accel build_accel(std::span<const Mesh> meshes, bool moving_meshes_only) {
  uint64_t total = 0;
  for (const Mesh& mesh : meshes) total += mesh.triangles.size();
  if (total >= kLeafBit)
    throw Error(ErrorCode::bad_input, "",
                "the scene has " + std::to_string(total) + " triangles; at most 2^31 - 1 can be traced");

  Sorted sorted = sort_by_motion(meshes, moving_meshes_only);
  Accel accel;
  build_tree(meshes, sorted.still, 0, accel.still);
  TriangleList().swap(sorted.still);
  for (auto& [times, triangles] : sorted.moving) {
    if (triangles.empty()) continue;
    for (size_t key = 0; key + 1 < times.size(); ++key) {
      if (times[key] == times[key + 1]) continue;  // a jump takes no time
      Tree<kMovingKeys> tree;
      tree.time_begin = times[key];
      tree.time_end = times[key + 1];
      build_tree(meshes, triangles, key, tree);
      accel.moving.push_back(std::move(tree));
    }
    TriangleList().swap(triangles);
  }
  return accel;
}

}  // namespace kairos
