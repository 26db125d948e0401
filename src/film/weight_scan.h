// The integral of a pixel's pieces times a weight of time. All of it is closed form: the product of two straight lines.
#pragma once

#include <algorithm>
#include <vector>

#include <kairos/time_weight.h>

#include "film/lanes.h"
#include "film/time_signal.h"
#include "film/time_tile.h"

namespace kairos {

class WeightScan {
 public:
  explicit WeightScan(const TimeWeight& weight) {
    const std::vector<TimeWeight::Point> points = weight.points();
    for (size_t i = 0; i + 1 < points.size(); ++i)
      if (points[i].time < points[i + 1].time)
        parts_.push_back({points[i].time, points[i + 1].time, points[i].weight, points[i + 1].weight});
  }

  /// Of the pieces [first, last) of a tile, which are all those of a pixel.
  Lanes integral(const TimeTile& tile, size_t first, size_t last) const {
    return tile.exact() ? integral(tile, tile.floats, first, last) : integral(tile, tile.halves, first, last);
  }

 private:
  struct Part {
    double begin, end, from, to;  // weight: on a straight line
  };

  template <class Number>
  Lanes integral(const TimeTile& tile, const PieceValues<Number>& values, size_t first, size_t last) const {
    Lanes sum{};
    size_t piece = first;
    for (const Part& part : parts_) {
      const auto end_of = [&](size_t i) { return i + 1 < last ? tile.begin[i + 1] * kTick : 1.0; };
      while (piece + 1 < last && end_of(piece) <= part.begin) ++piece;
      const double slope = (part.to - part.from) / (part.end - part.begin);
      for (; piece < last; ++piece) {
        const double begin = tile.begin[piece] * kTick, end = end_of(piece);
        const double from = std::max(begin, part.begin), to = std::min(end, part.end), length = to - from;
        const double at_from = part.from + (from - part.begin) * slope, at_to = part.from + (to - part.begin) * slope;
        const double weight = length * (at_from + at_to) / 2;
        double moment = length * (at_from + 2 * at_to) / 6;  // of all of the piece
        if (from != begin || to != end) {
          // Where the overlap lies in the piece, 0 to 1.
          const double inverse = 1 / (end - begin), first_place = (from - begin) * inverse,
                       last_place = (to - begin) * inverse;
          moment = length * (first_place * (2 * at_from + at_to) + last_place * (at_from + 2 * at_to)) / 6;
        }
        sum += load_lanes(values.left[piece]) * static_cast<float>(weight) +
               load_lanes(values.step[piece]) * static_cast<float>(moment);
        if (end > part.end) break;  // the next part begins in this piece
      }
    }
    return sum;
  }

  std::vector<Part> parts_;
};

}  // namespace kairos
