#include "accel/builder.h"

#include <algorithm>
#include <memory>

#include "accel/binning.h"
#include "base/parallel.h"

namespace kairos {

namespace {

/// Ranges above this are sorted, and their children built, in parallel.
constexpr uint32_t kParallelCount = 16384;
/// Pieces that a range is cut into: of no less than the grain, and no more than so many.
constexpr uint32_t kParallelGrain = 4096, kMostPieces = 64;
/// Below this level ranges are halved whatever it costs: it bounds the depth of trees over hostile geometry.
constexpr uint32_t kDeepestHeuristicLevel = 24;
/// A node has no fewer than so many primitives in its leaves, on average: what memory is set aside for.
constexpr uint32_t kPrimitivesPerNode = 24;

/// Primitives that will be below one node.
struct Range {
  uint32_t begin, end;
  uint32_t buffer;  // which of the two they are in
  BoxLanes box;
  Extent extent;

  uint32_t count() const { return end - begin; }
};

class Builder {
 public:
  Builder(std::span<Primitive> primitives, bool moving, std::span<TriangleId> order)
      : other_(primitives.size()), buffer_{primitives.data(), other_.data()}, order_(order), moving_(moving) {}

  WideTree build() {
    WideTree tree;
    Range all{0, static_cast<uint32_t>(order_.size()), 0, BoxLanes::empty(), Extent::none()};
    if (all.count() <= kWidth) {
      write_order(all);
      return tree;
    }
    measure(all);
    tree.depth = build_node(all, 0, tree.nodes);
    return tree;
  }

 private:
  /// Equal pieces of a range, the same ones whatever the number of threads.
  struct Pieces {
    uint32_t first, primitives, count;

    Pieces(uint32_t begin, uint32_t end)
        : first(begin),
          primitives(end - begin),
          count(primitives < kParallelCount ? 1 : std::min(kMostPieces, primitives / kParallelGrain)) {}
    uint32_t begin(size_t piece) const {
      return first + static_cast<uint32_t>(static_cast<uint64_t>(primitives) * piece / count);
    }
    template <class Body>
    void for_each(const Body& body) const {
      if (count == 1) return body(size_t{0});
      parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (size_t piece = begin; piece < end; ++piece) body(piece);
      });
    }
  };

  /// Sets box and extent from the primitives.
  void measure(Range& range) const {
    const Pieces pieces(range.begin, range.end);
    std::vector<std::pair<BoxLanes, Extent>> found(pieces.count, {BoxLanes::empty(), Extent::none()});
    pieces.for_each([&](size_t piece) {
      auto& [box, extent] = found[piece];
      for (uint32_t i = pieces.begin(piece); i < pieces.begin(piece + 1); ++i) {
        const BoxLanes& from = buffer_[range.buffer][i].box;
        box.include(from);
        extent.include(SortValues(from));
      }
    });
    range.box = BoxLanes::empty();
    range.extent = Extent::none();
    for (const auto& [box, extent] : found) {
      range.box.include(box);
      range.extent.include(extent);
    }
  }

  /// Splits `range` in two, neither of them empty: itself, which becomes the left one, and `right`.
  void split(Range& range, Range& right, bool halved) {
    const Binning binning(range.extent, moving_);
    if (halved || binning.axes == 0) return halve(range, right);
    const Pieces pieces(range.begin, range.end);
    if (pieces.count == 1) {
      Bins bins;
      bins.clear(binning.axes);
      bins.add(buffer_[range.buffer] + range.begin, range.count(), binning);
      return partition(range, right, pieces, binning, &bins, bins);
    }
    const auto bins = std::make_unique_for_overwrite<Bins[]>(pieces.count);
    pieces.for_each([&](size_t piece) {
      bins[piece].clear(binning.axes);
      const uint32_t begin = pieces.begin(piece);
      bins[piece].add(buffer_[range.buffer] + begin, pieces.begin(piece + 1) - begin, binning);
    });
    partition(range, right, pieces, binning, bins.get(), sum_of(bins.get(), pieces.count, binning.axes));
  }

  static Bins sum_of(const Bins* bins, size_t count, uint32_t axes) {
    Bins sum;
    sum.clear(axes);
    for (size_t piece = 0; piece < count; ++piece) sum.add(bins[piece], axes);
    return sum;
  }

  /// Where nothing tells the primitives apart, or nothing should.
  void halve(Range& range, Range& right) const {
    right.buffer = range.buffer;
    right.end = range.end;
    right.begin = range.end = range.begin + range.count() / 2;
    measure(range);
    measure(right);
  }

  /// Moves the primitives to the other buffer, those of the left side first. They keep their order on each side, so
  /// that it does not matter how the range was cut into pieces.
  void partition(Range& range, Range& right, const Pieces& pieces, const Binning& binning, const Bins* bins,
                 const Bins& all) {
    const Split where = all.cheapest(binning.axes, range.count());
    if (where.axis == kAxes) return halve(range, right);
    struct Piece {
      std::array<uint32_t, 2> next;  // where left and right ones go
      std::array<Extent, 2> extent;
    };
    const uint32_t middle = range.begin + where.left_count;
    std::array<Piece, kMostPieces> found;
    found[0].next[0] = range.begin;
    found[0].next[1] = middle;
    for (size_t piece = 1; piece < pieces.count; ++piece) {
      const uint32_t left = bins[piece - 1].count_left_of(where);
      found[piece].next[0] = found[piece - 1].next[0] + left;
      found[piece].next[1] = found[piece - 1].next[1] + (pieces.begin(piece) - pieces.begin(piece - 1)) - left;
    }
    pieces.for_each([&](size_t p) {
      Piece& piece = found[p];
      piece.extent[0] = piece.extent[1] = Extent::none();
      const uint32_t begin = pieces.begin(p), end = pieces.begin(p + 1);
      if (where.axis < kPlaceAxes)
        move<0>(buffer_[range.buffer] + begin, end - begin, binning, where, buffer_[1 - range.buffer], piece.next,
                piece.extent);
      else
        move<1>(buffer_[range.buffer] + begin, end - begin, binning, where, buffer_[1 - range.buffer], piece.next,
                piece.extent);
    });
    right = Range{middle, range.end, 1 - range.buffer, all.union_of(where.axis, where.bin, kBins), Extent::none()};
    range = Range{range.begin, middle, 1 - range.buffer, all.union_of(where.axis, 0, where.bin), Extent::none()};
    for (size_t piece = 0; piece < pieces.count; ++piece) {
      range.extent.include(found[piece].extent[0]);
      right.extent.include(found[piece].extent[1]);
    }
  }

  /// Moves n primitives to their side's place and measures the sides. kKind: of the axis that is split, 0 for place.
  template <size_t kKind>
  static void move(const Primitive* from, uint32_t n, const Binning& binning, const Split& split, Primitive* to,
                   std::array<uint32_t, 2>& next, std::array<Extent, 2>& extent) {
    const size_t lane = split.axis % kPlaceAxes;
    for (uint32_t i = 0; i < n; ++i) {
      const Primitive moved = from[i];
      const SortValues values(moved.box);
      const IntLanes bins = binning.bins(kKind == 0 ? values.place : values.velocity, kKind);
      const size_t side = static_cast<uint32_t>(bins[lane]) >= split.bin ? 1 : 0;
      to[next[side]++] = moved;
      extent[side].include(values);
    }
  }

  /// Appends the node of `range` (more than kWidth primitives) and all below it to `nodes`; returns the depth.
  uint32_t build_node(const Range& range, uint32_t level, std::vector<WideNode>& nodes) {
    std::array<Range, kWidth> child;
    std::array<float, kWidth> cost{};
    child[0] = range;
    uint32_t count = 1;
    while (count < kWidth) {
      // Open the child that is most likely to be met.
      int costliest = -1;
      float highest_cost = -1;
      for (uint32_t c = 0; c < count; ++c)
        if (child[c].count() > kWidth && !(cost[c] <= highest_cost)) {  // costs that are no number are the highest
          costliest = static_cast<int>(c);
          highest_cost = cost[c];
        }
      if (costliest < 0) break;
      const size_t opened = static_cast<size_t>(costliest);
      split(child[opened], child[count], level > kDeepestHeuristicLevel);
      cost[opened] = child[opened].box.cost();
      cost[count] = child[count].box.cost();
      ++count;
    }

    const bool parallel = range.count() >= kParallelCount;
    const size_t self = nodes.size();
    nodes.emplace_back();
    std::array<std::vector<WideNode>, kWidth> below;
    std::array<uint32_t, kWidth> depth{};
    const auto build_child = [&](size_t c, std::vector<WideNode>& out) {
      if (child[c].count() > kWidth)
        depth[c] = build_node(child[c], level + 1, out);
      else
        write_order(child[c]);
    };
    if (parallel) {
      parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
          if (child[c].count() < kParallelCount) below[c].reserve(child[c].count() / kPrimitivesPerNode);
          build_child(c, below[c]);
        }
      });
      size_t sum = 1;
      for (const auto& subtree : below) sum += subtree.size();
      nodes.reserve(sum);
    }
    uint32_t deepest = 0, leaves = 0;
    for (uint32_t c = 0; c < count; ++c) {
      const bool leaf = child[c].count() <= kWidth;
      leaves += leaf ? 1 : 0;
      nodes[self].child[c].set(child[c].box, child[c].begin, child[c].count(),
                               leaf ? kNoNode : static_cast<NodeRef>(nodes.size()));
      if (parallel)
        append(below[c], nodes);
      else
        build_child(c, nodes);
      deepest = std::max(deepest, depth[c]);
    }
    nodes[self].child_count = count;
    nodes[self].leaf_count = leaves;
    return deepest + 1;
  }

  void write_order(const Range& range) const {
    for (uint32_t i = range.begin; i < range.end; ++i) order_[i] = buffer_[range.buffer][i].id();
  }

  /// Moves a finished subtree behind `nodes`, so that the order is that of a serial build.
  static void append(std::vector<WideNode>& subtree, std::vector<WideNode>& nodes) {
    const NodeRef offset = static_cast<NodeRef>(nodes.size());
    for (WideNode& node : subtree) {
      for (uint32_t c = 0; c < node.child_count; ++c)
        if (!node.child[c].is_leaf()) node.child[c].move_node(offset);
      nodes.push_back(node);
    }
    std::vector<WideNode>().swap(subtree);
  }

  LargeArray<Primitive> other_;
  std::array<Primitive*, 2> buffer_;
  std::span<TriangleId> order_;
  bool moving_;
};

}  // namespace

WideTree build_wide_tree(std::span<Primitive> primitives, bool moving, std::span<TriangleId> order) {
  return Builder(primitives, moving, order).build();
}

}  // namespace kairos
