#include "time_page/reduced_picture.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "film/time_coder.h"
#include "film/time_signal.h"
#include "pixel/record_builder.h"

namespace kairos::time_page {

namespace {

/// Adds what a pixel shows as if a ray had seen it: the signal of a record is the mean over its rays.
void add_ray(RecordBuilder& record, std::span<const TimePiece> signal) {
  const uint32_t first = record.part_count();
  for (const TimePiece& piece : signal) {
    const auto knot = [&](double time, const std::array<float, 4>& value) {
      return record.add_knot(static_cast<float>(time), {value[0], value[1], value[2]}, {}, {});
    };
    SeenPart part;
    part.where.begin = static_cast<float>(piece.begin);
    part.where.end = static_cast<float>(piece.end);
    part.first_knot = knot(piece.begin, piece.left);
    if (piece.left != piece.right) {
      knot(piece.end, piece.right);
      part.knots = 2;
    }
    record.add_part(part);
  }
  record.add_ray({{}, 1, PixelRay::kAll, first, record.part_count() - first, 0});
}

}  // namespace

ReducedPicture reduced(const TimePicture& picture, int factor, double tolerance, int threads,
                       const std::function<bool(double)>& progress) {
  const TimeFrame& frame = picture.frame();
  ReducedPicture small{(frame.width + factor - 1) / factor, (frame.height + factor - 1) / factor, {}};
  const auto height = static_cast<size_t>(small.height);
  small.rows.resize(height);
  std::atomic<size_t> done{0};
  const auto make_row = [&](size_t row) {
    RecordBuilder record(false);
    TimeSignal signal;
    TimeCoder coder(tolerance);
    const int y0 = static_cast<int>(row) * factor, y1 = std::min(y0 + factor, frame.height);
    for (int x0 = 0; x0 < frame.width; x0 += factor) {
      record.begin_pixel(0, 0, {});
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < std::min(x0 + factor, frame.width); ++x)
          add_ray(record, picture.signal(frame.left + x, frame.top + y));
      const auto pieces = signal.make(record.finish());
      coder.add(pieces, signal.shift(), small.rows[row]);
    }
    done.fetch_add(1, std::memory_order_relaxed);
  };
  with_threads(
      threads,
      [&] {
        parallel_for(height, 1, [&](size_t begin, size_t end) {
          for (size_t row = begin; row < end; ++row) make_row(row);
        });
      },
      [&] { return !progress || progress(static_cast<double>(done) / static_cast<double>(height)); });
  return small;
}

}  // namespace kairos::time_page
