#include "accel/builder.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "base/parallel.h"

namespace kairos {

namespace {

constexpr uint32_t kBins = 16;
/// Axes 0 to 2 sort by place, 3 to 5 by velocity.
constexpr int kStillAxes = 3, kMovingAxes = 6;
/// Velocities that differ by less than this share of the range's extent are not worth a look: parting them saves no
/// swept area.
constexpr float kLeastVelocityShare = 0.25f;
/// Ranges above this are binned, and their children built, in parallel.
constexpr size_t kParallelCount = 8192;
constexpr size_t kParallelGrain = 4096;
/// Below this level ranges are halved whatever it costs: it bounds the depth of trees over hostile geometry.
constexpr uint32_t kDeepestHeuristicLevel = 24;
/// Triangles of a leaf are tested together; a range costs as many block tests as it will fill blocks of about this
/// size.
constexpr uint32_t kBlockFill = 4;

struct Bin {
  MovingBox box = MovingBox::empty();
  uint32_t count = 0;

  void include(const Bin& other) {
    box.include(other.box);
    count += other.count;
  }
};

struct Bins {
  std::array<std::array<Bin, kBins>, kMovingAxes> bin;

  void include(const Bins& other, int axes) {
    for (size_t a = 0; a < static_cast<size_t>(axes); ++a)
      for (size_t b = 0; b < kBins; ++b) bin[a][b].include(other.bin[a][b]);
  }
};

/// Maps sort values of a range to bins; an axis on which all values agree has scale 0.
struct Binning {
  std::array<float, kMovingAxes> low{}, scale{};

  uint32_t operator()(const MovingBox& box, int axis) const {
    const size_t a = static_cast<size_t>(axis);
    const float place = (box.sort_value(axis) - low[a]) * scale[a];
    return std::min(kBins - 1, static_cast<uint32_t>(std::max(place, 0.0f)));
  }
};

struct Range {
  uint32_t begin = 0, end = 0;
  MovingBox box = MovingBox::empty();

  uint32_t count() const { return end - begin; }
};

struct Split {
  int axis = -1;
  uint32_t bin = 0;  ///< the left side holds bins 0 to bin - 1
};

float block_tests(uint32_t count) { return static_cast<float>((count + kBlockFill - 1) / kBlockFill); }

class Builder {
 public:
  Builder(std::span<Primitive> primitives, bool moving)
      : primitives_(primitives), axes_(moving ? kMovingAxes : kStillAxes) {}

  WideTree build() {
    WideTree tree;
    if (primitives_.size() <= kWidth) return tree;
    Range all{0, static_cast<uint32_t>(primitives_.size()), MovingBox::empty()};
    all.box = bounds(all);
    tree.depth = build_node(all, 0, tree.nodes);
    return tree;
  }

 private:
  /// Runs body(begin, end, partial) over pieces of a range and joins the partial results. Joining is commutative and
  /// exact (minima and counts), so the outcome does not depend on how the range was cut or in which order pieces
  /// finished.
  template <class Result, class Body, class Join>
  Result reduce(const Range& range, Result zero, Body body, Join join) const {
    if (range.count() < kParallelCount) {
      body(range.begin, range.end, zero);
      return zero;
    }
    Result total = zero;
    std::mutex mutex;
    parallel_for(range.count(), kParallelGrain, [&](size_t begin, size_t end) {
      Result partial = zero;
      body(range.begin + static_cast<uint32_t>(begin), range.begin + static_cast<uint32_t>(end), partial);
      const std::lock_guard lock(mutex);
      join(total, partial);
    });
    return total;
  }

  MovingBox bounds(const Range& range) const {
    return reduce(
        range, MovingBox::empty(),
        [&](uint32_t begin, uint32_t end, MovingBox& box) {
          for (uint32_t i = begin; i < end; ++i) box.include(primitives_[i].box);
        },
        [](MovingBox& total, const MovingBox& part) { total.include(part); });
  }

  Binning make_binning(const Range& range) const {
    struct Extent {
      std::array<float, kMovingAxes> low, high;
    };
    Extent none;
    none.low.fill(std::numeric_limits<float>::infinity());
    none.high.fill(-std::numeric_limits<float>::infinity());
    const Extent extent = reduce(
        range, none,
        [&](uint32_t begin, uint32_t end, Extent& e) {
          for (uint32_t i = begin; i < end; ++i)
            for (int axis = 0; axis < axes_; ++axis) {
              const size_t a = static_cast<size_t>(axis);
              const float value = primitives_[i].box.sort_value(axis);
              e.low[a] = std::min(e.low[a], value);
              e.high[a] = std::max(e.high[a], value);
            }
        },
        [](Extent& total, const Extent& part) {
          for (size_t a = 0; a < kMovingAxes; ++a) {
            total.low[a] = std::min(total.low[a], part.low[a]);
            total.high[a] = std::max(total.high[a], part.high[a]);
          }
        });
    Binning binning;
    float largest = 0;
    for (size_t a = 0; a < kStillAxes; ++a) largest = std::max(largest, extent.high[a] - extent.low[a]);
    for (size_t a = 0; a < static_cast<size_t>(axes_); ++a) {
      const float size = extent.high[a] - extent.low[a];
      if (a >= kStillAxes && size < kLeastVelocityShare * largest) continue;
      // Just under kBins, so that the largest value falls into the last bin.
      const float scale = 0.999f * static_cast<float>(kBins) / size;
      binning.low[a] = extent.low[a];
      binning.scale[a] = size > 0 && std::isfinite(scale) ? scale : 0;
    }
    return binning;
  }

  Split find_split(const Range& range, const Binning& binning) const {
    const auto all = reduce(
        range, std::vector<Bins>(1),
        [&](uint32_t begin, uint32_t end, std::vector<Bins>& bins) {
          for (uint32_t i = begin; i < end; ++i) {
            const MovingBox& box = primitives_[i].box;
            for (int axis = 0; axis < axes_; ++axis) {
              if (binning.scale[static_cast<size_t>(axis)] == 0) continue;
              Bin& bin = bins[0].bin[static_cast<size_t>(axis)][binning(box, axis)];
              bin.box.include(box);
              ++bin.count;
            }
          }
        },
        [&](std::vector<Bins>& total, const std::vector<Bins>& part) { total[0].include(part[0], axes_); });
    Split best;
    float best_cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < axes_; ++axis) {
      const auto& bins = all[0].bin[static_cast<size_t>(axis)];
      if (binning.scale[static_cast<size_t>(axis)] == 0) continue;
      std::array<float, kBins> right_cost{};
      Bin right;
      for (uint32_t b = kBins - 1; b > 0; --b) {
        right.include(bins[b]);
        right_cost[b] = right.count == 0 ? 0 : right.box.cost() * block_tests(right.count);
      }
      Bin left;
      for (uint32_t b = 1; b < kBins; ++b) {
        left.include(bins[b - 1]);
        if (left.count == 0 || left.count == range.count()) continue;
        const float cost = left.box.cost() * block_tests(left.count) + right_cost[b];
        if (cost < best_cost) {
          best_cost = cost;
          best = {axis, b};
        }
      }
    }
    return best;
  }

  /// Splits `range` in two, neither of them empty.
  std::pair<Range, Range> split(const Range& range, bool halve) {
    const Binning binning = make_binning(range);
    const Split at = halve ? Split{} : find_split(range, binning);
    uint32_t middle = range.begin + range.count() / 2;  // where nothing tells the primitives apart
    if (at.axis >= 0) {
      const auto first = primitives_.begin() + range.begin, last = primitives_.begin() + range.end;
      const auto edge =
          std::partition(first, last, [&](const Primitive& p) { return binning(p.box, at.axis) < at.bin; });
      middle = static_cast<uint32_t>(edge - primitives_.begin());
    }
    Range left{range.begin, middle, MovingBox::empty()}, right{middle, range.end, MovingBox::empty()};
    left.box = bounds(left);
    right.box = bounds(right);
    return {left, right};
  }

  /// Appends the node of `range` (more than kWidth primitives) and all below it to `nodes`; returns the depth.
  uint32_t build_node(const Range& range, uint32_t level, std::vector<WideNode>& nodes) {
    std::array<Range, kWidth> child;
    child[0] = range;
    uint32_t count = 1;
    while (count < kWidth) {
      // Open the child that is most likely to be met.
      int costliest = -1;
      float highest_cost = -1;
      for (uint32_t c = 0; c < count; ++c) {
        const float cost = child[c].box.cost();
        if (child[c].count() > kWidth && cost > highest_cost) {
          costliest = static_cast<int>(c);
          highest_cost = cost;
        }
      }
      if (costliest < 0) break;
      auto [left, right] = split(child[static_cast<size_t>(costliest)], level > kDeepestHeuristicLevel);
      child[static_cast<size_t>(costliest)] = left;
      child[count++] = right;
    }

    const size_t self = nodes.size();
    nodes.emplace_back();
    std::array<std::vector<WideNode>, kWidth> below;
    std::array<uint32_t, kWidth> depth{};
    const auto build_child = [&](size_t c, std::vector<WideNode>& out) {
      if (child[c].count() > kWidth) depth[c] = build_node(child[c], level + 1, out);
    };
    const bool parallel = range.count() >= kParallelCount;
    if (parallel)
      parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) build_child(c, below[c]);
      });
    uint32_t deepest = 0;
    for (uint32_t c = 0; c < count; ++c) {
      WideChild out{child[c].box, child[c].begin, child[c].count(), kNoNode};
      if (child[c].count() > kWidth) {
        out.node = static_cast<NodeRef>(nodes.size());
        if (parallel)
          append(below[c], nodes);
        else
          build_child(c, nodes);
      }
      nodes[self].child[c] = out;
      deepest = std::max(deepest, depth[c]);
    }
    nodes[self].child_count = count;
    return deepest + 1;
  }

  /// Moves a finished subtree behind `nodes`, so that the order is that of a serial build.
  static void append(std::vector<WideNode>& subtree, std::vector<WideNode>& nodes) {
    const NodeRef offset = static_cast<NodeRef>(nodes.size());
    for (WideNode& node : subtree) {
      for (uint32_t c = 0; c < node.child_count; ++c)
        if (node.child[c].node != kNoNode) node.child[c].node += offset;
      nodes.push_back(node);
    }
    std::vector<WideNode>().swap(subtree);
  }

  std::span<Primitive> primitives_;
  int axes_;
};

}  // namespace

WideTree build_wide_tree(std::span<Primitive> primitives, bool moving) { return Builder(primitives, moving).build(); }

}  // namespace kairos
