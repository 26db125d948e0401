// How far away the nearest of a few moving things is, as a function of time.
#pragma once

#include <cstdint>
#include <vector>

#include "film/object_tile.h"

namespace kairos {

/// One thread's memory, reused from function to function.
class DepthFunction {
 public:
  /// tolerance: how far, relative to the distance, pieces may leave it: at the ends of all stretches. 0: not at all.
  explicit DepthFunction(double tolerance) : tolerance_(tolerance) {}

  void clear() { stretches_.clear(); }
  /// Something is at a distance that goes on a straight line, from one shutter time to another.
  void add(float begin, float end, float dist_begin, float dist_end);

  /// The nearest at each instant, as few pieces.
  void append_to(DepthPieces& out);

 private:
  struct Stretch {
    uint64_t begin = 0, end = 0;  // ticks
    double from = 0, to = 0;
    double at(uint64_t tick) const {
      return from + (to - from) * (static_cast<double>(tick - begin) / static_cast<double>(end - begin));
    }
  };

  void find_nearest();

  double tolerance_;
  std::vector<Stretch> stretches_, active_, nearest_;
  std::vector<uint64_t> cuts_;
};

}  // namespace kairos
