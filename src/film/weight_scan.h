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
    for (size_t i = 0; i + 1 < points.size(); ++i) {
      const TimeWeight::Point &a = points[i], &b = points[i + 1];
      if (a.time < b.time)
        parts_.push_back({a.time, b.time, a.weight, (b.weight - a.weight) / (b.time - a.time), tick_before(a.time),
                          tick_before(b.time)});
    }
  }

  /// Of the pieces [first, last) of a tile, which are all those of a pixel.
  Lanes integral(const TimeTile& tile, size_t first, size_t last) const {
    return tile.exact() ? integral(tile, tile.floats, first, last) : integral(tile, tile.halves, first, last);
  }

 private:
  static uint64_t tick_before(double time) { return static_cast<uint64_t>(time * static_cast<double>(kTicks)); }

  struct Part {
    double begin, end, from, slope;  // weight: on a straight line
    uint64_t begin_tick, end_tick;   // at or before begin and end
  };

  template <class Number>
  Lanes integral(const TimeTile& tile, const PieceValues<Number>& values, size_t first, size_t last) const {
    const auto end_of = [&](size_t i) { return i + 1 < last ? tile.begin[i + 1] : kTicks; };
    Lanes sum{};
    size_t piece = first;
    for (const Part& part : parts_) {
      while (end_of(piece) <= part.begin_tick && piece + 1 < last) ++piece;
      sum += overlap(values, piece, tile.begin[piece], end_of(piece), part);
      if (end_of(piece) > part.end_tick) continue;  // the next part begins in this piece
      ++piece;
      // Most pieces lie in the part with all of their time, and most weights are constant there.
      const size_t inside = piece;
      while (piece < last && end_of(piece) <= part.end_tick) ++piece;
      if (part.slope == 0) {
        Lanes constant{};
        for (size_t i = inside; i < piece; ++i)
          constant += (load_lanes(values.left[i]) + load_lanes(values.step[i]) * 0.5f) *
                      static_cast<float>(static_cast<int64_t>(end_of(i) - tile.begin[i]));
        sum += constant * static_cast<float>(part.from * kTick);
      } else {
        for (size_t i = inside; i < piece; ++i) sum += overlap(values, i, tile.begin[i], end_of(i), part);
      }
      if (piece < last) sum += overlap(values, piece, tile.begin[piece], end_of(piece), part);
      piece = std::min(piece, last - 1);
    }
    return sum;
  }

  /// Of what a piece and a part of the weight have in common.
  template <class Number>
  static Lanes overlap(const PieceValues<Number>& values, size_t piece, uint64_t begin_tick, uint64_t end_tick,
                       const Part& part) {
    const double begin = static_cast<double>(begin_tick) * kTick, end = static_cast<double>(end_tick) * kTick;
    const double from = std::max(begin, part.begin), to = std::min(end, part.end), length = to - from;
    if (!(length > 0)) return Lanes{};
    const double at_from = part.from + (from - part.begin) * part.slope,
                 at_to = part.from + (to - part.begin) * part.slope;
    const double weight = length * (at_from + at_to) / 2;
    double moment = length * (at_from + 2 * at_to) / 6;  // of all of the piece
    if (from != begin || to != end) {
      // Where the overlap lies in the piece, 0 to 1.
      const double inverse = 1 / (end - begin), first_place = (from - begin) * inverse,
                   last_place = (to - begin) * inverse;
      moment = length * (first_place * (2 * at_from + at_to) + last_place * (at_from + 2 * at_to)) / 6;
    }
    return load_lanes(values.left[piece]) * static_cast<float>(weight) +
           load_lanes(values.step[piece]) * static_cast<float>(moment);
  }

  std::vector<Part> parts_;
};

}  // namespace kairos
