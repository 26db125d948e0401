// Where to split a range of primitives: bins along six axes, and what each way would cost.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "accel/box_lanes.h"
#include "accel/layout.h"

namespace kairos {

inline constexpr uint32_t kBins = 16;
/// Axes 0 to 2 sort by place, 3 to 5 by velocity.
inline constexpr size_t kPlaceAxes = 3, kAxes = 6;
/// Velocities that differ by less than this share of the range's extent are not worth a look: parting them saves no
/// swept area.
inline constexpr float kLeastVelocityShare = 0.25f;
/// Triangles of a block are tested together, and what each of them costs beyond that is a small share of it, measured
/// on the scenes of docs/scenes.md. So ranges are split where blocks will be full, if that costs little else.
inline constexpr float kCostPerTriangle = 0.25f;
/// The same where triangles have several key spans: in most of them a triangle costs next to nothing (around-inl.h),
/// and a block that is not full takes memory at every key.
inline constexpr float kCostPerTriangleOfSeveralSpans = 0.06f;

/// What the triangles below a node cost once it is met, in block tests.
inline float block_tests(uint32_t count, float cost_per_triangle) {
  return static_cast<float>((count + kWidth - 1) / kWidth) + cost_per_triangle * static_cast<float>(count);
}

/// Smallest and negated largest sort values of a range. Values that are no number, from sums that overflow, leave it as
/// it is.
struct Extent {
  std::array<Lanes, 2> low, negative_high;  ///< place, velocity

  static Extent none() {
    const Lanes infinity = all_lanes(std::numeric_limits<float>::infinity());
    return {{infinity, infinity}, {infinity, infinity}};
  }
  void include(const SortValues& values) {
    low[0] = lower_of(values.place, low[0]);
    negative_high[0] = lower_of(-values.place, negative_high[0]);
    low[1] = lower_of(values.velocity, low[1]);
    negative_high[1] = lower_of(-values.velocity, negative_high[1]);
  }
  void include(const Extent& other) {
    for (size_t kind = 0; kind < 2; ++kind) {
      low[kind] = lower_of(other.low[kind], low[kind]);
      negative_high[kind] = lower_of(other.negative_high[kind], negative_high[kind]);
    }
  }
};

/// Maps sort values of a range to bins.
struct Binning {
  std::array<Lanes, 2> low{}, scale{};  ///< place, velocity
  uint32_t axes = 0;                    ///< those on which values differ, as a mask

  Binning(const Extent& extent, bool moving) {
    float largest = 0;
    for (size_t axis = 0; axis < (moving ? kAxes : kPlaceAxes); ++axis) {
      const size_t kind = axis / kPlaceAxes, a = axis % kPlaceAxes;
      const float from = extent.low[kind][a], size = -extent.negative_high[kind][a] - from;
      if (kind == 0)
        largest = std::max(largest, size);
      else if (size < kLeastVelocityShare * largest)
        continue;
      // Just under kBins, so that the largest value falls into the last bin.
      const float to_bins = 0.999f * static_cast<float>(kBins) / size;
      if (!(size > 0 && to_bins > 0 && std::isfinite(to_bins))) continue;
      low[kind][a] = from;
      scale[kind][a] = to_bins;
      axes |= 1u << axis;
    }
  }

  /// The bins on all axes of a kind (0: place, 1: velocity).
  IntLanes bins(Lanes values, size_t kind) const {
    const Lanes bin = (values - low[kind]) * scale[kind];
    return __builtin_convertvector(lower_of(higher_of(bin, Lanes{}), all_lanes(kBins - 1)), IntLanes);
  }
};

struct Split {
  size_t axis = kAxes;  ///< kAxes: there is none
  uint32_t bin = 0;     ///< the left side holds bins 0 to bin - 1
  uint32_t left_count = 0;
};

/// Boxes and counts of the bins. Those of axes not in use are not set.
struct Bins {
  BoxLanes box[kAxes][kBins];
  uint32_t count[kAxes][kBins];

  /// All that add() writes to, whether it is in use or not.
  void clear(uint32_t axes) {
    for (size_t axis = 0; axis < ((axes >> kPlaceAxes) == 0 ? kPlaceAxes : kAxes); ++axis) {
      std::fill_n(box[axis], kBins, BoxLanes::empty());
      std::fill_n(count[axis], kBins, 0u);
    }
  }

  void add(const Primitive* primitives, size_t n, const Binning& binning) {
    if ((binning.axes >> kPlaceAxes) == 0)
      add_along<kPlaceAxes>(primitives, n, binning);
    else
      add_along<kAxes>(primitives, n, binning);
  }

  void add(const Bins& other, uint32_t axes) {
    for (size_t axis = 0; axis < kAxes; ++axis) {
      if ((axes >> axis & 1) == 0) continue;
      for (size_t b = 0; b < kBins; ++b) {
        box[axis][b].include(other.box[axis][b]);
        count[axis][b] += other.count[axis][b];
      }
    }
  }

  uint32_t count_left_of(const Split& split) const {
    uint32_t sum = 0;
    for (size_t b = 0; b < split.bin; ++b) sum += count[split.axis][b];
    return sum;
  }
  BoxLanes union_of(size_t axis, size_t begin, size_t end) const {
    BoxLanes sum = BoxLanes::empty();
    for (size_t b = begin; b < end; ++b) sum.include(box[axis][b]);
    return sum;
  }

  /// The cheapest way to split `total` primitives; none if there is none of finite cost.
  Split cheapest(uint32_t axes, uint32_t total, float cost_per_triangle) const {
    Split best;
    float best_cost = std::numeric_limits<float>::infinity();
    for (size_t axis = 0; axis < kAxes; ++axis) {
      if ((axes >> axis & 1) == 0) continue;
      float right_cost[kBins];
      BoxLanes side = BoxLanes::empty();
      uint32_t side_count = 0;
      float cost = 0;
      for (size_t b = kBins - 1; b > 0; --b) {
        if (count[axis][b] != 0) {
          side.include(box[axis][b]);
          side_count += count[axis][b];
          cost = side.cost() * block_tests(side_count, cost_per_triangle);
        }
        right_cost[b] = cost;
      }
      side = BoxLanes::empty();
      side_count = 0;
      for (uint32_t b = 1; b < kBins; ++b) {
        if (count[axis][b - 1] == 0) continue;
        side.include(box[axis][b - 1]);
        side_count += count[axis][b - 1];
        if (side_count == total) break;
        cost = side.cost() * block_tests(side_count, cost_per_triangle) + right_cost[b];
        if (cost < best_cost) {
          best_cost = cost;
          best = {axis, b, side_count};
        }
      }
    }
    return best;
  }

 private:
  template <size_t kCount>
  void add_along(const Primitive* primitives, size_t n, const Binning& binning) {
    for (size_t i = 0; i < n; ++i) {
      const BoxLanes from = primitives[i].box;
      const SortValues values(from);
      const IntLanes place = binning.bins(values.place, 0), velocity = binning.bins(values.velocity, 1);
      for (size_t axis = 0; axis < kCount; ++axis) {
        const size_t b = static_cast<size_t>(axis < kPlaceAxes ? place[axis] : velocity[axis - kPlaceAxes]);
        box[axis][b].include(from);
        ++count[axis][b];
      }
    }
  }
};

}  // namespace kairos
