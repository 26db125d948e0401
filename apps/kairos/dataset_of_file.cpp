#include <kairos/error.h>
#include <kairos/time_file.h>

#include "dataset_source.h"
#include "time_arguments.h"

namespace kairos::cli {

namespace {

class FileSource : public DatasetSource {
 public:
  FileSource(const std::string& path, std::optional<double> fps, int threads)
      : path_(path), file_(TimeFile::open(path)), fps_(fps.value_or(frame().fps)), threads_(threads) {}

  const TimeFile& file() const { return file_; }
  const TimeFrame& frame() const { return file_.picture().frame(); }

  double fps() const override { return fps_; }
  std::array<int, 2> size() const override { return {frame().frame_width, frame().frame_height}; }
  ViewTransform view() const override { return frame().view; }
  const Shot* shot() const override { return file_.has_geometry() ? &shot_ : nullptr; }

  void begin(int, const FrameTimes& times) override {
    check_recorded(path_, frame(), times.open, times.close);
    if (!(times.close > times.open))
      throw Error(ErrorCode::bad_usage, "", "a data set needs exposures of some length; give another --shutter");
    times_ = times;
    if (file_.has_geometry())
      shot_ = file_.shot(std::max(times.open, frame().open), std::min(times.close, frame().close));
  }

  std::vector<Image> expose(std::span<const Shutter> shutters) override {
    ExposeOptions options;
    options.threads = threads_;
    options.progress = progress;
    std::vector<Image> images;
    for (Shutter shutter : shutters) {  // whose times are from this frame, and not from the file's
      const double later = times_.frame_time - frame().frame_time;
      shutter.open += later;
      shutter.close += later;
      const bool instant = shutter.open == shutter.close && shutter.open_line == shutter.close_line;
      images.push_back(instant && shutter.open_line == 0 ? file_.at(shutter.open, options)
                                                         : file_.expose(shutter, options));
    }
    return images;
  }

  Image flow(double from, double to) override {
    check_recorded(path_, frame(), from, to);
    FlowOptions options;
    options.threads = threads_;
    options.progress = progress;
    return file_.flow(from - frame().frame_time, to - frame().frame_time, options);
  }

 private:
  std::string path_;
  TimeFile file_;
  double fps_;
  int threads_;
  FrameTimes times_;
  Shot shot_;
};

}  // namespace

std::unique_ptr<DatasetSource> dataset_of_file(const std::string& path, std::optional<double> fps, int threads,
                                               bool needs_shot, const std::string& layout) {
  auto source = std::make_unique<FileSource>(path, fps, threads);
  const TimeFrame& frame = source->frame();
  if (!source->file().info().finished)
    throw Error(ErrorCode::bad_input, path, "is not finished; render it to its end for a data set");
  if (frame.width != frame.frame_width || frame.height != frame.frame_height)
    throw Error(ErrorCode::bad_input, path, "holds a part of the frame; render it without --crop for a data set");
  if (needs_shot && !source->file().has_geometry())
    throw Error(ErrorCode::bad_input, path,
                "does not hold where things are, which flow, depth and poses of " + layout +
                    " are made of; render it again with --time-planes geometry");
  return source;
}

}  // namespace kairos::cli
