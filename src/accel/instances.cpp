#include "accel/instances.h"

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include <kairos/error.h>

#include "accel/builder.h"
#include "accel/moving_meshes.h"
#include "accel/placed_box.h"
#include "accel/wide_nodes.h"
#include "base/parallel.h"

namespace kairos {

namespace {

constexpr uint32_t kInstanceGrain = 1024;  // per piece of a parallel loop

/// Boxes that hold an object: those of its root's children, or of its only block's triangles.
class ObjectBoxes {
 public:
  explicit ObjectBoxes(const StillTree& tree) {
    if (tree.root == kNoNode) return;
    if ((tree.root & kLeafBit) == 0) {
      const auto& node = tree.nodes[tree.root];
      for (size_t c = 0; c < node.count; ++c) {
        Box& box = boxes_.emplace_back();
        for (size_t axis = 0; axis < 3; ++axis) {
          box.low[axis] = node.lower[0][axis][c];
          box.high[axis] = node.upper[0][axis][c];
        }
      }
      return;
    }
    const auto& block = tree.blocks[tree.root & ~kLeafBit];
    for (size_t t = 0; t < block.count; ++t) {
      Box& box = boxes_.emplace_back();
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto& position = block.position[0];
        box.low[axis] = std::min({position[0][axis][t], position[1][axis][t], position[2][axis][t]});
        box.high[axis] = std::max({position[0][axis][t], position[1][axis][t], position[2][axis][t]});
      }
    }
  }

  bool empty() const { return boxes_.empty(); }

  /// Smallest coordinates, and the largest negated, of the placed object.
  std::array<Lanes, 2> placed(const AffineMap& map) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::array<Lanes, 2> bounds{all_lanes(kInfinity), all_lanes(kInfinity)};
    for (const Box& box : boxes_)
      for (size_t axis = 0; axis < 3; ++axis) {
        const PlacedExtent extent(map, axis, box.low, box.high);
        bounds[0][axis] = std::min(bounds[0][axis], extent.lower);
        bounds[1][axis] = std::min(bounds[1][axis], -extent.upper);
      }
    return bounds;
  }

 private:
  struct Box {
    float low[3], high[3];
  };
  std::vector<Box> boxes_;
};

/// Instances, those of one tree, in the order of their meshes.
struct List {
  std::vector<Instance> instances;
  std::vector<AffineMap> placements;
  std::vector<float> times;
};

void set_bounds(const List& list, const Instance& instance, const ObjectBoxes& object, BoxLanes& box) {
  const auto bounds_at_key = [&](size_t key) { return object.placed(list.placements[instance.first_placement + key]); };
  const auto begin = bounds_at_key(0), end = bounds_at_key(instance.spans);
  box.bound = {begin[0], begin[1], end[0], end[1]};
  if (instance.spans > 1)
    widen_over_keys(std::span(list.times).subspan(instance.first_time, instance.spans + 1), 0, instance.spans, {},
                    bounds_at_key, box);
}

template <int kKeys>
void build_tree(const List& list, const std::vector<ObjectBoxes>& boxes, InstanceTree<kKeys>& tree) {
  LargeArray<Primitive> primitives(list.instances.size());
  parallel_for(primitives.size(), kInstanceGrain, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const Instance& instance = list.instances[i];
      set_bounds(list, instance, boxes[instance.object], primitives[i].box);
      primitives[i].set_id({static_cast<uint32_t>(i), 0});
    }
  });
  // One instance a leaf: what is saved by not looking at an object is far more than a node costs.
  const WideTree wide = build_wide_tree(primitives, kKeys == kMovingKeys, nullptr, 1);
  const std::vector<Leaf> leaves = set_nodes(wide, tree);
  tree.instances.resize(leaves.size());
  tree.placements.reserve(list.placements.size());
  for (size_t leaf = 0; leaf < leaves.size(); ++leaf) {  // neighbours in the tree are neighbours in memory
    Instance& instance = tree.instances[leaf] = list.instances[leaves[leaf].triangles.front().mesh];
    const auto from = list.placements.begin() + instance.first_placement;
    instance.first_placement = static_cast<uint32_t>(tree.placements.size());
    tree.placements.insert(tree.placements.end(), from, from + instance.spans + 1);
  }
  tree.times = list.times;
}

}  // namespace

void build_instances(std::span<const Mesh> meshes, bool moving_meshes_only,
                     const std::function<void(const Mesh& object, StillTree& tree)>& build_object, Accel& accel) {
  std::vector<const Mesh*> objects;
  std::map<const Mesh*, uint32_t> known;
  std::map<std::vector<float>, uint32_t> known_times;
  List still, moving;
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    if (!mesh.object || mesh.object->triangles.empty() || (moving_meshes_only && mesh.is_static())) continue;
    const auto [place, is_new] = known.emplace(mesh.object.get(), static_cast<uint32_t>(objects.size()));
    if (is_new) objects.push_back(mesh.object.get());
    List& list = mesh.is_static() ? still : moving;
    Instance instance{m, place->second, static_cast<uint32_t>(mesh.key_count() - 1),
                      static_cast<uint32_t>(list.placements.size()), 0};
    if (!mesh.is_static()) {
      const auto [times, new_times] = known_times.emplace(mesh.key_times, static_cast<uint32_t>(list.times.size()));
      if (new_times) list.times.insert(list.times.end(), mesh.key_times.begin(), mesh.key_times.end());
      instance.first_time = times->second;
    }
    if (list.placements.size() + mesh.placements.size() > std::numeric_limits<uint32_t>::max())
      throw Error(ErrorCode::bad_input, "", "instances have more than 2^32 motion keys; use a shorter shutter");
    list.placements.insert(list.placements.end(), mesh.placements.begin(), mesh.placements.end());
    list.instances.push_back(instance);
  }
  accel.objects.resize(objects.size());
  parallel_for(objects.size(), 1, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) build_object(*objects[i], accel.objects[i]);
  });
  std::vector<ObjectBoxes> boxes;
  boxes.reserve(objects.size());
  for (const StillTree& object : accel.objects) boxes.emplace_back(object);
  if (!still.instances.empty()) build_tree(still, boxes, accel.still_instances);
  if (!moving.instances.empty()) build_tree(moving, boxes, accel.moving_instances);
}

}  // namespace kairos
