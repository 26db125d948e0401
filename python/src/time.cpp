// Pictures over time: rendered once, exposed afterwards.
#include <algorithm>

#include <kairos/render.h>
#include <kairos/time_file.h>

#include "bindings.h"
#include "image.h"
#include "params.h"
#include "shot.h"

namespace kairos::python {

namespace {

TimePicture record(const std::shared_ptr<HeldShot>& held, const py::dict& values, double tolerance,
                   py::object callback) {
  RenderParams params = render_params(*held, values);
  params.exposure.reset();  // rays look at all of the time that is kept
  const Progress progress = progress_of(std::move(callback));
  const py::gil_scoped_release unlocked;
  const Shot& shot = held->shot_for(params.shading);
  TimeFilm film(shot, params, tolerance, {held->frame_time(), held->fps()});
  PixelConsumer* const consumers[] = {&film};
  Renderer(shot).render(params, consumers, nullptr, progress);
  return film.take();
}

/// The same, into a file, which is then opened.
TimePicture record_file(const std::shared_ptr<HeldShot>& held, const py::dict& values, double tolerance,
                        const std::string& path, py::object callback) {
  RenderParams params = render_params(*held, values);
  params.exposure.reset();
  const Progress progress = progress_of(std::move(callback));
  const py::gil_scoped_release unlocked;
  const Shot& shot = held->shot_for(params.shading);
  TimeFileWriter writer(path, shot, params, {tolerance, {held->frame_time(), held->fps()}, ""});
  PixelConsumer* const consumers[] = {&writer};
  Renderer(shot).render(params, consumers, nullptr, progress);
  writer.finish();
  return TimeFile::open(path).picture();
}

ExposeOptions expose_options(bool coverage, py::object callback) {
  ExposeOptions options;
  options.coverage = coverage;
  options.progress = progress_of(std::move(callback));
  return options;
}

py::dict expose(const TimePicture& picture, py::object shutter, bool coverage, py::object callback) {
  const TimeFrame& frame = picture.frame();
  Shutter chosen;
  if (shutter.is_none()) {
    chosen.open = frame.open - frame.frame_time;
    chosen.close = frame.close - frame.frame_time;
  } else {
    chosen = shutter_from(shutter);
  }
  const ExposeOptions options = expose_options(coverage, std::move(callback));
  Image image;
  {
    const py::gil_scoped_release unlocked;
    const Exposure exposure(chosen, frame.frame_time, frame.frame_width, frame.frame_height, frame.open, frame.close);
    const bool rows = chosen.scan == Scan::top || chosen.scan == Scan::bottom;
    const bool rolls = chosen.open_line != 0 || chosen.close_line != 0;
    image = picture.expose({[exposure](int x, int y) { return exposure.weight(x, y); }, rolls && !rows, rolls && rows},
                           options);
  }
  return image_to(std::move(image));
}

py::dict at(const TimePicture& picture, double time, bool coverage) {
  if (!(time >= 0 && time <= 1)) refuse("time", "is not from 0, when the shutter opens, to 1, when it closes");
  const ExposeOptions options = expose_options(coverage, py::none());
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = picture.at(time, options);
  }
  return image_to(std::move(image));
}

/// (begin, end, left, right), columns of a pixel's pieces.
py::tuple signal(const TimePicture& picture, int x, int y) {
  const std::vector<TimePiece> pieces = picture.signal(x, y);
  std::vector<double> begin, end;
  std::vector<float> left, right;
  for (const TimePiece& piece : pieces) {
    begin.push_back(piece.begin);
    end.push_back(piece.end);
    left.insert(left.end(), piece.left.begin(), piece.left.end());
    right.insert(right.end(), piece.right.begin(), piece.right.end());
  }
  const auto count = static_cast<py::ssize_t>(pieces.size());
  return py::make_tuple(array_from(std::move(begin), {count}), array_from(std::move(end), {count}),
                        array_from(std::move(left), {count, 4}), array_from(std::move(right), {count, 4}));
}

py::dict about(const TimePicture& picture) {
  const TimeFrame& frame = picture.frame();
  const TimeQuality quality = picture.quality();
  Writer f;
  f("width", frame.width);
  f("height", frame.height);
  f("open", frame.open);
  f("close", frame.close);
  f("frame_time", frame.frame_time);
  f("fps", frame.fps);
  f("tolerance", quality.tolerance);
  f("deviation", quality.deviation);
  f("rounding", quality.rounding);
  f("pieces", quality.pieces);
  f("missing", quality.missing);
  return f.values;
}

}  // namespace

void bind_time(py::module_& module) {
  py::class_<TimePicture>(module, "TimePicture")
      .def("expose", &expose)
      .def("at", &at)
      .def("signal", &signal)
      .def("about", &about);
  module.def("record", &record);
  module.def("record_file", &record_file);
  module.def("open_time", [](const std::string& path) {
    const py::gil_scoped_release unlocked;
    return TimeFile::open(path).picture();
  });
}

}  // namespace kairos::python
