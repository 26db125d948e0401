// Where shading samples lie in time and which random numbers they get, whatever shot they are part of.
#pragma once

#include <cmath>
#include <cstdint>

#include "math/hash.h"
#include "shading/light_points.h"

namespace kairos {

/// Divides scene time into intervals of as many cells as a ray takes shading samples in one: a grid that goes on from
/// shot to shot. Positions on it count cells.
class TimeGrid {
 public:
  /// One interval from shutter time 0 to 1.
  explicit TimeGrid(uint32_t cells = 1) : cells_(cells), scale_(cells) {}
  /// open, close, interval: scene time; interval > 0.
  TimeGrid(double open, double close, double interval, uint32_t cells)
      : cells_(cells), origin_(open / interval * cells), scale_((close - open) / interval * cells) {}

  uint32_t cells() const { return cells_; }  ///< of an interval
  /// Cells that the shutter is open for.
  double count() const { return scale_; }
  double place(float time) const { return origin_ + scale_ * static_cast<double>(time); }
  float time_at(double place) const { return static_cast<float>((place - origin_) / scale_); }

 private:
  uint32_t cells_;
  double origin_ = 0, scale_;
};

/// Names the shading samples of a pixel's rays by ray and cell, so that a name depends neither on what was shaded
/// before nor on where a shot begins. Samples of an interval are spread evenly over every light together.
class SampleKeys {
 public:
  explicit SampleKeys(const TimeGrid& grid) : grid_(grid) {}

  void begin_ray(uint64_t pixel_seed, uint32_t ray) {
    if (pixel_seed != pixel_seed_) known_ = false;
    pixel_seed_ = pixel_seed;
    ray_ = ray;
    cell_ = kNone;
  }

  /// Of a ray's samples in their order in time. Of several in one cell, each has numbers of its own.
  SampleKey next(float time) {
    const double cell = std::floor(grid_.place(time));
    rank_ = cell == cell_ ? rank_ + 1 : 0;
    cell_ = cell;
    SampleKey key = at(cell);
    if (rank_ > 0) key.seed = hash(key.seed, rank_);
    return key;
  }

  /// Of a cell.
  SampleKey at(double cell) {
    const double interval = std::floor(cell / grid_.cells());
    if (!known_ || interval != interval_) {
      seed_ = hash(pixel_seed_, kKeyDimension, static_cast<uint64_t>(static_cast<int64_t>(interval)));
      known_ = true;
      interval_ = interval;
    }
    return {seed_, ray_ * grid_.cells() + static_cast<uint32_t>(cell - interval * grid_.cells())};
  }

 private:
  static constexpr double kNone = -0x1p60;      // no cell
  static constexpr uint64_t kKeyDimension = 5;  // beside x, y, time and shares

  TimeGrid grid_;
  uint64_t pixel_seed_ = 0, seed_ = 0;
  uint32_t ray_ = 0;
  uint64_t rank_ = 0;
  double cell_ = kNone, interval_ = 0;
  bool known_ = false;  // is seed_ that of the interval?
};

}  // namespace kairos
