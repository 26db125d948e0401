// From a pixel's record to what each mesh contributes to it over time.
#pragma once

#include <vector>

#include <kairos/record.h>

#include "film/depth_function.h"
#include "film/object_tile.h"
#include "film/time_coder.h"
#include "film/time_signal.h"

namespace kairos {

/// One thread's memory, reused from pixel to pixel.
class ObjectCoder {
 public:
  /// tolerance: TimeQuality's.
  explicit ObjectCoder(double tolerance) : coder_(tolerance), depth_(tolerance == 0 ? 0 : kDepthTolerance) {}

  /// How far distances may be off, relative to them, unless everything is exact.
  static constexpr double kDepthTolerance = 1e-3;

  /// Appends a pixel.
  void add(const PixelRecord& record, ObjectTile& out);

 private:
  void find_meshes(const PixelRecord& record);
  void add_depth(const PixelRecord& record, uint32_t mesh, DepthPieces& out);

  TimeSignal signal_;
  TimeCoder coder_;
  DepthFunction depth_;
  std::vector<uint32_t> meshes_;
};

}  // namespace kairos
