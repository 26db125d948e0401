// Many lights in a tree, from which one is chosen by what it may be worth at a point.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <kairos/vec.h>

namespace kairos {

/// An axis-aligned box.
struct LightBox {
  Vec3d low, high;
};

/// A light, or several, over all of the shutter.
struct LightBounds {
  LightBox first, last;    ///< within what it is when the shutter opens and when it closes; in between it is within the
                           ///< box in between
  Vec3d axis{0, 0, 1};     ///< unit: light leaves within `spread` of it and then up to `fade`; radians
  double spread = 3.1416;  ///< half the opening angle of the cone of normals; pi and more: any
  double fade = 1.5708;    ///< how far from a normal light goes
  bool two_sided = false;  ///< about the opposite of the axis, too
  double power = 0;        ///< in any unit, above 0: worth this much over squared distance

  /// From where it is at some times from 0 to 1, ascending, between which it moves straight. times: of no interest if
  /// there is one box.
  void set_boxes(std::span<const LightBox> boxes, std::span<const float> times);
};

/// Chance goes down from the root, at every node in proportion to what either side may be worth: power over squared
/// distance, less where it lies low over the surface or shines elsewhere, and 0 where nothing of it can arrive. A.
/// Conty and C. Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018. The leaf's lights are the
/// caller's to choose from.
class LightTree {
 public:
  /// leaf_size: most lights in a leaf, at least 1; if there are no more than that, all are in one.
  LightTree(std::span<const LightBounds> lights, size_t leaf_size);
  LightTree() = default;

  /// Lights by number, leaf by leaf.
  const std::vector<uint32_t>& order() const { return order_; }

  struct Leaf {
    uint32_t begin = 0, end = 0;  ///< of order(); the same for no leaf
    double probability = 0;
  };
  /// time: of the shutter; normal: of the surface that is lit, unit. u: uniform in [0, 1); what is left of it is so,
  /// too.
  Leaf choose(Vec3d point, Vec3d normal, float time, double& u) const;
  /// The leaf that holds order()[place], and how likely choose() is to give it.
  Leaf leaf_of(uint32_t place, Vec3d point, Vec3d normal, float time) const;

 private:
  struct Node {
    LightBounds bounds;
    uint32_t begin = 0, end = 0;  // of order_
    uint32_t second = 0;          // child; the first one follows its parent. 0: a leaf
  };
  void build(std::span<const LightBounds> lights, uint32_t begin, uint32_t end, size_t leaf_size, int depth);
  static double worth(const LightBounds& bounds, Vec3d point, Vec3d normal, double time);
  /// How likely chance goes to the first of an inner node's two; nothing where neither is worth anything.
  std::optional<double> share_of_first(size_t index, Vec3d point, Vec3d normal, double time) const;

  std::vector<Node> nodes_;
  std::vector<uint32_t> order_;
};

}  // namespace kairos
