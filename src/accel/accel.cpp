#include "accel/accel.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

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

using TriangleList = LargeArray<TriangleId>;

struct Sorted {
  TriangleList still, moving;
};

/// Sorts triangles into lists, in which they keep their order.
Sorted sort_by_motion(std::span<const Mesh> meshes, bool moving_meshes_only) {
  struct Piece {
    uint32_t mesh, begin, end;
    uint32_t still_count, still_offset, moving_offset;

    uint32_t moving_count() const { return end - begin - still_count; }
  };
  std::vector<Piece> pieces;
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    if (moving_meshes_only && mesh.is_static()) continue;
    const uint32_t count = static_cast<uint32_t>(mesh.triangles.size());
    for (uint64_t begin = 0; begin < count; begin += kGrain)
      pieces.push_back(
          {m, static_cast<uint32_t>(begin), static_cast<uint32_t>(std::min<uint64_t>(count, begin + kGrain)), 0, 0, 0});
  }
  const auto each_piece = [&](const auto& body) {
    parallel_for(pieces.size(), 1, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) body(pieces[p], meshes[pieces[p].mesh]);
    });
  };
  each_piece([](Piece& piece, const Mesh& mesh) {
    if (mesh.is_static()) {
      piece.still_count = piece.end - piece.begin;
      return;
    }
    for (uint32_t f = piece.begin; f < piece.end; ++f) piece.still_count += is_still(mesh, mesh.triangles[f]) ? 1 : 0;
  });
  uint32_t still_count = 0, moving_count = 0;
  for (Piece& piece : pieces) {
    piece.still_offset = still_count;
    piece.moving_offset = moving_count;
    still_count += piece.still_count;
    moving_count += piece.moving_count();
  }
  Sorted sorted;
  sorted.still.resize(still_count);
  sorted.moving.resize(moving_count);
  each_piece([&](const Piece& piece, const Mesh& mesh) {
    TriangleId* still = sorted.still.data() + piece.still_offset;
    TriangleId* moving = sorted.moving.data() + piece.moving_offset;
    for (uint32_t f = piece.begin; f < piece.end; ++f)
      (mesh.is_static() || is_still(mesh, mesh.triangles[f]) ? *still++ : *moving++) = {piece.mesh, f};
  });
  return sorted;
}

/// Bounds of a triangle at one key: smallest coordinates, and the largest negated.
std::array<Lanes, 2> bounds_at(const Mesh& mesh, const Triangle& triangle, size_t key) {
  const Vec3f* positions = mesh.positions[key].data();
  const Vec3f a = positions[triangle[0]], b = positions[triangle[1]], c = positions[triangle[2]];
  std::array<Lanes, 2> bounds{};
  for (int axis = 0; axis < 3; ++axis) {
    bounds[0][axis] = std::min(std::min(a[axis], b[axis]), c[axis]);
    bounds[1][axis] = -std::max(std::max(a[axis], b[axis]), c[axis]);
  }
  return bounds;
}

/// When the meshes' keys are, by the sets of key times that there are.
class KeySets {
 public:
  explicit KeySets(std::span<const Mesh> meshes) : of_mesh_(meshes.size(), 0) {
    std::map<std::span<const float>, uint32_t, Less> known;
    for (size_t m = 0; m < meshes.size(); ++m) {
      if (meshes[m].is_static()) continue;
      const auto [place, is_new] = known.emplace(meshes[m].key_times, static_cast<uint32_t>(times_.size()));
      if (is_new) times_.push_back(meshes[m].key_times);
      of_mesh_[m] = place->second;
    }
  }

  uint32_t set_of(uint32_t mesh) const { return of_mesh_[mesh]; }
  std::span<const float> times(uint32_t mesh) const { return times_[of_mesh_[mesh]]; }
  std::span<const float> times_of_set(uint32_t set) const { return times_[set]; }
  /// True when some triangle may have more than one key span.
  bool several_spans() const {
    return std::any_of(times_.begin(), times_.end(), [](const auto& times) { return times.size() > 2; });
  }
  /// First and last key of a window that begins and ends at keys. Of several keys at one time, those inside.
  std::pair<size_t, size_t> keys_in(uint32_t mesh, TimeRange window) const {
    const auto all = times(mesh);
    if (all.size() == 2) return {0, 1};
    return {std::upper_bound(all.begin(), all.end(), window.begin) - all.begin() - 1,
            std::lower_bound(all.begin(), all.end(), window.end) - all.begin()};
  }

 private:
  struct Less {
    bool operator()(std::span<const float> a, std::span<const float> b) const {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    }
  };
  std::vector<uint32_t> of_mesh_;
  std::vector<std::span<const float>> times_;
};

/// What rounding does to a bound that is computed from the line between two keys is less than this share of the largest
/// coordinate: a ratio, two differences, a product and three sums of values up to three times as large, each rounded to
/// within 2^-24.
constexpr float kLineError = 32 * 0x1p-24f;

class MovingMeshes final : public MovingTriangles {
 public:
  MovingMeshes(std::span<const Mesh> meshes, const KeySets& keys) : meshes_(meshes), keys_(keys) {}

  uint32_t spans(uint32_t mesh, TimeRange window) const override {
    const auto [first, last] = keys_.keys_in(mesh, window);
    return static_cast<uint32_t>(last - first);
  }
  std::optional<float> middle_key(uint32_t mesh, TimeRange window) const override {
    const auto times = keys_.times(mesh);
    const float middle = window.begin + (window.end - window.begin) / 2;
    std::optional<float> nearest;
    const auto consider = [&](float time) {
      if (time > window.begin && time < window.end &&
          (!nearest || std::abs(time - middle) < std::abs(*nearest - middle)))
        nearest = time;
    };
    const auto after = std::lower_bound(times.begin(), times.end(), middle);
    if (after != times.begin()) consider(after[-1]);
    if (after != times.end()) consider(*after);
    return nearest;
  }
  bool has_key(uint32_t mesh, float time) const override {
    const auto times = keys_.times(mesh);
    return std::binary_search(times.begin(), times.end(), time);
  }
  bool same_keys(uint32_t mesh, uint32_t other) const override { return keys_.set_of(mesh) == keys_.set_of(other); }

  /// Between its first and last key in the window a bound may leave the line between the two: the line is moved out as
  /// far as it must. Between neighbouring keys vertices move straight, so keys alone decide.
  void set_primitive(TriangleId id, TimeRange window, Primitive& primitive) const override {
    const Mesh& mesh = meshes_[id.mesh];
    const Triangle& triangle = mesh.triangles[id.triangle];
    const auto [first, last] = keys_.keys_in(id.mesh, window);
    auto& bound = primitive.box.bound;
    const auto begin = bounds_at(mesh, triangle, first), end = bounds_at(mesh, triangle, last);
    for (size_t side = 0; side < 2; ++side) {
      bound[side] = begin[side];
      bound[2 + side] = end[side];
    }
    if (last - first > 1) widen(mesh, triangle, first, last, window, primitive.box);
    primitive.set_id(id);
  }

 private:
  static Lanes sizes(Lanes a) { return higher_of(a, -a); }

  void widen(const Mesh& mesh, const Triangle& triangle, size_t first, size_t last, TimeRange window,
             BoxLanes& box) const {
    std::array<Lanes, 2> off{}, largest, lowest;
    for (size_t side = 0; side < 2; ++side) {
      largest[side] = higher_of(sizes(box.bound[side]), sizes(box.bound[2 + side]));
      lowest[side] = lower_of(box.bound[side], box.bound[2 + side]);
    }
    const float length = window.end - window.begin;
    for (size_t key = first + 1; key < last; ++key) {
      const auto here = bounds_at(mesh, triangle, key);
      const float time = (mesh.key_times[key] - window.begin) / length;
      for (size_t side = 0; side < 2; ++side) {
        const Lanes begin = box.bound[side], end = box.bound[2 + side];
        const Lanes line = begin + all_lanes(time) * (end - begin);
        off[side] = lower_of(here[side] - line, off[side]);
        largest[side] = higher_of(sizes(here[side]), largest[side]);
        lowest[side] = lower_of(here[side], lowest[side]);
      }
    }
    for (size_t side = 0; side < 2; ++side) {
      off[side] -= all_lanes(kLineError) * largest[side];
      for (size_t end = 0; end < 2; ++end) {
        Lanes& bound = box.bound[2 * end + side];
        const Lanes moved = bound + off[side];
        // Where sums overflow the box stands still instead: at its lowest.
        bound = largest[side] < all_lanes(kSafeSize) ? moved : lowest[side];
      }
    }
  }

  /// Differences and sums of a few numbers up to here don't overflow.
  static constexpr float kSafeSize = 1e37f;

  std::span<const Mesh> meshes_;
  const KeySets& keys_;
};

/// Children of a node; its leaves are numbered from `first_leaf` on.
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

/// The triangles of a leaf, and when it is there.
struct Leaf {
  std::span<const TriangleId> triangles;
  TimeRange window;

  TriangleId in_slot(uint32_t slot) const { return triangles[slot < triangles.size() ? slot : 0]; }
};

/// The leaves in the order of their nodes, so that neighbours in the tree are neighbours in memory; sets nodes and
/// root.
template <class TreeOfNodes>
std::vector<Leaf> set_nodes(const WideTree& wide, TreeOfNodes& tree) {
  std::vector<Leaf> leaves;
  tree.depth = wide.depth;
  if (wide.order.empty()) return leaves;
  const std::span<const TriangleId> order(wide.order);
  if (wide.nodes.empty()) {
    tree.root = kLeafBit;
    leaves.push_back({order, {}});
    return leaves;
  }
  tree.root = 0;
  std::vector<uint32_t> first_leaf(wide.nodes.size());
  uint32_t count = 0;
  for (size_t n = 0; n < wide.nodes.size(); ++n) {
    first_leaf[n] = count;
    count += wide.nodes[n].leaf_count;
  }
  leaves.resize(count);
  tree.nodes.resize(wide.nodes.size());
  parallel_for(wide.nodes.size(), kNodeGrain, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const WideNode& node = wide.nodes[n];
      set_node(node, first_leaf[n], tree.nodes[n]);
      uint32_t leaf = first_leaf[n];
      for (uint32_t c = 0; c < node.child_count; ++c)
        if (node.child[c].is_leaf())
          leaves[leaf++] = {order.subspan(node.child[c].begin(), node.child[c].count()), node.child[c].window()};
    }
  });
  return leaves;
}

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
  for (const Mesh& mesh : meshes) total += mesh.triangles.size();
  if (total >= kLeafBit)
    throw Error(ErrorCode::bad_input, "",
                "the scene has " + std::to_string(total) + " triangles; at most 2^31 - 1 can be traced");

  Sorted sorted = sort_by_motion(meshes, moving_meshes_only);
  Accel accel;
  build_still(meshes, sorted.still, accel.still);
  TriangleList().swap(sorted.still);
  build_moving(meshes, sorted.moving, accel.moving);
  return accel;
}

}  // namespace kairos
