#include "accel/builder.h"

#include <algorithm>
#include <memory>
#include <utility>

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

/// How many primitives of a range are looked at to decide whether it is split in time.
constexpr uint32_t kTimeSplitSample = 64;
/// Triangles of one leaf have at most so many times as many key spans as any other: what those that have fewer repeat
/// takes memory.
constexpr uint32_t kSpansRatio = 2;

/// Two buffers that primitives of the same window of time are moved between.
struct Store {
  std::array<LargeArray<Primitive>, 2> owned;
  std::array<Primitive*, 2> buffer;
  TimeRange window;

  /// Of given primitives, over the whole shutter.
  explicit Store(std::span<Primitive> primitives) : buffer{primitives.data(), nullptr} {
    owned[1].resize(primitives.size());
    buffer[1] = owned[1].data();
  }
  Store(uint32_t count, TimeRange window_of_all) : window(window_of_all) {
    for (size_t i = 0; i < 2; ++i) {
      owned[i].resize(count);
      buffer[i] = owned[i].data();
    }
  }
};

/// Primitives that will be below one node.
struct Range {
  uint32_t begin, end;
  uint32_t which;  // of the store's buffers
  std::shared_ptr<Store> store;
  BoxLanes box;
  Extent extent;
  std::optional<float> time_split = std::nullopt;  // when it should be split in time
  bool leaf = false;

  uint32_t count() const { return end - begin; }
  Primitive* primitives() const { return store->buffer[which] + begin; }
};

class Builder {
 public:
  Builder(bool moving, const MovingTriangles* several_spans, uint32_t leaf_size)
      : moving_(moving), triangles_(several_spans), leaf_size_(leaf_size) {}

  WideTree build(std::span<Primitive> primitives) const {
    WideTree tree;
    Range all{0,
              static_cast<uint32_t>(primitives.size()),
              0,
              std::make_shared<Store>(primitives),
              BoxLanes::empty(),
              Extent::none()};
    if (all.count() == 0) return tree;
    measure(all);
    plan(all, 0);
    if (all.leaf)
      add_to_order(all, tree.order);
    else
      tree.depth = build_node(std::move(all), 0, tree);
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
        const BoxLanes& from = range.store->buffer[range.which][i].box;
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
  void split(Range& range, Range& right, bool halved) const {
    right.store = range.store;
    if (range.count() <= leaf_size_) return split_by_spans(range, right);
    const Binning binning(range.extent, moving_);
    if (halved || binning.axes == 0) return halve(range, right);
    const Pieces pieces(range.begin, range.end);
    if (pieces.count == 1) {
      Bins bins;
      bins.clear(binning.axes);
      bins.add(range.primitives(), range.count(), binning);
      return partition(range, right, pieces, binning, &bins, bins);
    }
    const auto bins = std::make_unique_for_overwrite<Bins[]>(pieces.count);
    pieces.for_each([&](size_t piece) {
      bins[piece].clear(binning.axes);
      const uint32_t begin = pieces.begin(piece);
      bins[piece].add(range.store->buffer[range.which] + begin, pieces.begin(piece + 1) - begin, binning);
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
  void halve(Range& range, Range& right) const { cut(range, right, range.count() / 2); }

  void cut(Range& range, Range& right, uint32_t left_count) const {
    right.which = range.which;
    right.end = range.end;
    right.begin = range.end = range.begin + left_count;
    measure(range);
    measure(right);
  }

  uint32_t spans_of(const Range& range, uint32_t primitive) const {
    return triangles_->spans(range.primitives()[primitive].id().mesh, range.store->window);
  }

  /// Parts triangles that have few key spans from those that have many: where the numbers differ most.
  void split_by_spans(Range& range, Range& right) const {
    const auto fewer = [&](const Primitive& a, const Primitive& b) {
      return triangles_->spans(a.id().mesh, range.store->window) < triangles_->spans(b.id().mesh, range.store->window);
    };
    // A few primitives, sorted by insertion: std::stable_sort's buffer does not keep to their alignment.
    Primitive *const first = range.primitives(), *const last = first + range.count();
    for (Primitive* next = first; next != last; ++next)
      std::rotate(std::upper_bound(first, next, *next, fewer), next, next + 1);
    uint32_t where = 1;
    float largest = 0;
    for (uint32_t i = 1; i < range.count(); ++i) {
      const float ratio = static_cast<float>(spans_of(range, i)) / static_cast<float>(spans_of(range, i - 1));
      if (ratio > largest) {
        largest = ratio;
        where = i;
      }
    }
    cut(range, right, where);
  }

  /// Decides what becomes of a range that has been measured.
  void plan(Range& range, uint32_t level) const {
    range.leaf = range.count() <= leaf_size_;
    range.time_split.reset();
    if (triangles_ == nullptr) return;
    if (level <= kDeepestHeuristicLevel) range.time_split = when_to_split(range);
    if (!range.leaf) return;
    uint32_t least = spans_of(range, 0), most = least;
    for (uint32_t i = 1; i < range.count(); ++i) {
      least = std::min(least, spans_of(range, i));
      most = std::max(most, spans_of(range, i));
    }
    range.leaf = !range.time_split && most <= kSpansRatio * least;
  }

  /// A common key that parts the range into two whose boxes together cost less than its own; none if there is none.
  std::optional<float> when_to_split(const Range& range) const {
    const TimeRange window = range.store->window;
    const Primitive* primitives = range.primitives();
    const uint32_t first = primitives[0].id().mesh, count = range.count();
    const std::optional<float> time = triangles_->middle_key(first, window);
    if (!time) return std::nullopt;
    for (uint32_t i = 1; i < count; ++i) {
      const uint32_t mesh = primitives[i].id().mesh;
      if (!triangles_->same_keys(first, mesh) && !triangles_->has_key(mesh, *time)) return std::nullopt;
    }
    BoxLanes whole = BoxLanes::empty(), before = whole, after = whole;
    const uint32_t sampled = std::min(count, kTimeSplitSample);
    for (uint32_t s = 0; s < sampled; ++s) {
      const Primitive& from = primitives[static_cast<uint64_t>(count) * s / sampled];
      Primitive part;
      whole.include(from.box);
      triangles_->set_primitive(from.id(), {window.begin, *time}, part);
      before.include(part.box);
      triangles_->set_primitive(from.id(), {*time, window.end}, part);
      after.include(part.box);
    }
    const bool pays = before.cost() + after.cost() < whole.cost();
    return pays ? time : std::nullopt;
  }

  /// Splits `range` at its time into two of all its triangles.
  void split_in_time(Range& range, Range& right) const {
    const TimeRange window = range.store->window;
    right = part_in_time(range, {*range.time_split, window.end});
    range = part_in_time(range, {window.begin, *range.time_split});
  }

  Range part_in_time(const Range& range, TimeRange window) const {
    Range part{0, range.count(), 0, std::make_shared<Store>(range.count(), window), BoxLanes::empty(), Extent::none()};
    const Primitive* from = range.primitives();
    parallel_for(range.count(), kParallelGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) triangles_->set_primitive(from[i].id(), window, part.store->buffer[0][i]);
    });
    measure(part);
    return part;
  }

  /// Moves the primitives to the other buffer, those of the left side first. They keep their order on each side, so
  /// that it does not matter how the range was cut into pieces.
  void partition(Range& range, Range& right, const Pieces& pieces, const Binning& binning, const Bins* bins,
                 const Bins& all) const {
    const Split where = all.cheapest(binning.axes, range.count(),
                                     triangles_ == nullptr ? kCostPerTriangle : kCostPerTriangleOfSeveralSpans);
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
    const Primitive* from = range.store->buffer[range.which];
    Primitive* to = range.store->buffer[1 - range.which];
    pieces.for_each([&](size_t p) {
      Piece& piece = found[p];
      piece.extent[0] = piece.extent[1] = Extent::none();
      const uint32_t begin = pieces.begin(p), end = pieces.begin(p + 1);
      if (where.axis < kPlaceAxes)
        move<0>(from + begin, end - begin, binning, where, to, piece.next, piece.extent);
      else
        move<1>(from + begin, end - begin, binning, where, to, piece.next, piece.extent);
    });
    right.begin = middle;
    right.end = range.end;
    range.end = middle;
    range.which = right.which = 1 - range.which;
    range.box = all.union_of(where.axis, 0, where.bin);
    right.box = all.union_of(where.axis, where.bin, kBins);
    range.extent = right.extent = Extent::none();
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

  /// Appends the node of `range`, which is no leaf, and all below it to `tree`; returns the depth.
  uint32_t build_node(Range range, uint32_t level, WideTree& tree) const {
    const bool parallel = range.count() >= kParallelCount;
    std::array<Range, kWidth> child;
    std::array<float, kWidth> cost{};
    child[0] = std::move(range);
    uint32_t count = 1;
    while (count < kWidth) {
      // Open the child that is most likely to be met.
      int costliest = -1;
      float highest_cost = -1;
      for (uint32_t c = 0; c < count; ++c)
        if (!child[c].leaf && !(cost[c] <= highest_cost)) {  // costs that are no number are the highest
          costliest = static_cast<int>(c);
          highest_cost = cost[c];
        }
      if (costliest < 0) break;
      const size_t opened = static_cast<size_t>(costliest);
      if (child[opened].time_split)
        split_in_time(child[opened], child[count]);
      else
        split(child[opened], child[count], level > kDeepestHeuristicLevel);
      for (const size_t c : {opened, static_cast<size_t>(count)}) {
        cost[c] = child[c].box.cost();
        plan(child[c], level);
      }
      ++count;
    }

    std::array<TimeRange, kWidth> windows;  // ranges are given away while their children are built
    for (uint32_t c = 0; c < count; ++c) windows[c] = child[c].store->window;

    const size_t self = tree.nodes.size();
    tree.nodes.emplace_back();
    std::array<WideTree, kWidth> below;
    const auto build_child = [&](size_t c, WideTree& out) {
      uint32_t depth = 0;
      if (child[c].leaf)
        add_to_order(child[c], out.order);
      else
        depth = build_node(std::move(child[c]), level + 1, out);
      return depth;
    };
    if (parallel) {
      parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
          if (child[c].count() < kParallelCount) {
            below[c].nodes.reserve(child[c].count() / kPrimitivesPerNode);
            below[c].order.reserve(child[c].count());
          }
          below[c].depth = build_child(c, below[c]);
        }
      });
      size_t nodes = tree.nodes.size(), triangles = tree.order.size();
      for (const WideTree& subtree : below) {
        nodes += subtree.nodes.size();
        triangles += subtree.order.size();
      }
      tree.nodes.reserve(nodes);
      tree.order.reserve(triangles);
    }
    uint32_t deepest = 0, leaves = 0;
    for (uint32_t c = 0; c < count; ++c) {
      WideChild& to = tree.nodes[self].child[c];
      const TimeRange window = windows[c];
      if (child[c].leaf)
        to.set_leaf(child[c].box, window, static_cast<uint32_t>(tree.order.size()), child[c].count());
      else
        to.set_node(child[c].box, window, static_cast<NodeRef>(tree.nodes.size()));
      leaves += child[c].leaf ? 1 : 0;
      if (parallel)
        append(below[c], tree);
      else
        below[c].depth = build_child(c, tree);
      deepest = std::max(deepest, below[c].depth);
    }
    tree.nodes[self].child_count = count;
    tree.nodes[self].leaf_count = leaves;
    return deepest + 1;
  }

  static void add_to_order(const Range& range, std::vector<TriangleId>& order) {
    for (uint32_t i = 0; i < range.count(); ++i) order.push_back(range.primitives()[i].id());
  }

  /// Moves a finished subtree behind `tree`, so that the order is that of a serial build.
  static void append(WideTree& subtree, WideTree& tree) {
    const uint32_t nodes = static_cast<uint32_t>(tree.nodes.size()), order = static_cast<uint32_t>(tree.order.size());
    for (WideNode& node : subtree.nodes) {
      for (uint32_t c = 0; c < node.child_count; ++c) node.child[c].move(nodes, order);
      tree.nodes.push_back(node);
    }
    tree.order.insert(tree.order.end(), subtree.order.begin(), subtree.order.end());
    std::vector<WideNode>().swap(subtree.nodes);
    std::vector<TriangleId>().swap(subtree.order);
  }

  bool moving_;
  const MovingTriangles* triangles_;
  uint32_t leaf_size_;
};

}  // namespace

WideTree build_wide_tree(std::span<Primitive> primitives, bool moving, const MovingTriangles* several_spans,
                         uint32_t leaf_size) {
  return Builder(moving, several_spans, leaf_size).build(primitives);
}

}  // namespace kairos
