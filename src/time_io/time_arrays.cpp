#include <array>

#include <kairos/error.h>
#include <kairos/time_arrays.h>

#include "base/npz_file.h"

namespace kairos {

namespace {

/// All pieces, pixel by pixel. Rows of the picture are added from the top.
class Pieces {
 public:
  explicit Pieces(const std::string& path)
      : offsets_(path, "offsets", "'<i8'"),
        begin_(path, "begin", "'<f8'"),
        end_(path, "end", "'<f8'"),
        left_(path, "left", "'<f4'", 4),
        right_(path, "right", "'<f4'", 4) {
    offsets_.put(count_);
  }

  void add_row(const TimePicture& picture, int y) {
    const TimeFrame& frame = picture.frame();
    for (int x = 0; x < frame.width; ++x) {
      for (const TimePiece& piece : picture.signal(frame.left + x, frame.top + y)) {
        begin_.put(piece.begin);
        end_.put(piece.end);
        for (const float value : piece.left) left_.put(value);
        for (const float value : piece.right) right_.put(value);
        ++count_;
      }
      offsets_.put(count_);
    }
    for (NpyColumn* column : columns()) column->flush();
  }

  void add_to(NpzFile& npz) {
    for (NpyColumn* column : columns()) column->add_to(npz);
  }

 private:
  std::array<NpyColumn*, 5> columns() { return {&offsets_, &begin_, &end_, &left_, &right_}; }

  NpyColumn offsets_, begin_, end_, left_, right_;
  int64_t count_ = 0;
};

}  // namespace

void write_time_arrays(const TimePicture& picture, const std::string& path,
                       const std::function<bool(double fraction)>& progress) {
  const TimeFrame& frame = picture.frame();
  NpzFile npz(path);
  Pieces pieces(path);
  for (int y = 0; y < frame.height; ++y) {
    if (progress && !progress(static_cast<double>(y) / frame.height))
      throw Error(ErrorCode::cancelled, "", "writing " + path + " was stopped");
    pieces.add_row(picture, y);
  }
  pieces.add_to(npz);
  const auto add = [&](const char* name, const char* descr, auto... values) {
    NpyColumn column(path, name, descr);
    (column.put(values), ...);
    column.add_to(npz);
  };
  const TimeQuality quality = picture.quality();
  add("size", "'<i4'", int32_t{frame.width}, int32_t{frame.height});
  add("frame", "'<i4'", int32_t{frame.frame_width}, int32_t{frame.frame_height}, int32_t{frame.left},
      int32_t{frame.top});
  add("shutter", "'<f8'", frame.open, frame.close);
  add("frame_time", "'<f8'", frame.frame_time);
  add("fps", "'<f8'", frame.fps);
  add("pixel_aspect", "'<f8'", frame.pixel_aspect);
  add("alpha", "'|b1'", static_cast<uint8_t>(frame.alpha));
  add("deviation", "'<f8'", quality.deviation);
  add("rounding", "'<f8'", quality.rounding);
  npz.finish();
}

}  // namespace kairos
