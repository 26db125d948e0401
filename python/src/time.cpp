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

/// A picture over time, and the file that it is of, if there is one.
struct HeldTime {
  TimePicture picture;
  std::shared_ptr<const TimeFile> file;

  explicit HeldTime(TimePicture in_memory) : picture(std::move(in_memory)) {}
  explicit HeldTime(const std::string& path) : HeldTime(std::make_shared<const TimeFile>(TimeFile::open(path))) {}
  explicit HeldTime(std::shared_ptr<const TimeFile> of) : picture(of->picture()), file(std::move(of)) {}

  bool has_geometry() const { return file != nullptr && file->has_geometry(); }
  const TimeFile& with_geometry() const {
    if (!has_geometry())
      refuse("geometry", "is not held; record(..., file=..., geometry=True) and --time-planes geometry keep it");
    return *file;
  }
};

HeldTime record(const std::shared_ptr<HeldShot>& held, const py::dict& values, double tolerance, bool objects,
                py::object callback) {
  RenderParams params = render_params(*held, values);
  params.exposure.reset();  // rays look at all of the time that is kept
  const Progress progress = progress_of(std::move(callback));
  const py::gil_scoped_release unlocked;
  const Shot& shot = held->shot_for(params.shading);
  TimeFilm film(shot, params, tolerance, {held->frame_time(), held->fps()}, objects);
  PixelConsumer* const consumers[] = {&film};
  Renderer(shot).render(params, consumers, nullptr, progress);
  return HeldTime(film.take());
}

/// The same, into a file, which is then opened.
HeldTime record_file(const std::shared_ptr<HeldShot>& held, const py::dict& values, double tolerance, bool objects,
                     bool geometry, const std::string& path, py::object callback) {
  RenderParams params = render_params(*held, values);
  params.exposure.reset();
  const Progress progress = progress_of(std::move(callback));
  const py::gil_scoped_release unlocked;
  const Shot& shot = held->shot_for(params.shading);
  TimeFileWriter writer(path, shot, params, {tolerance, {held->frame_time(), held->fps()}, "", objects, geometry});
  PixelConsumer* const consumers[] = {&writer};
  Renderer(shot).render(params, consumers, nullptr, progress);
  writer.finish();
  return HeldTime(path);
}

ExposeOptions expose_options(bool coverage, py::object callback) {
  ExposeOptions options;
  options.coverage = coverage;
  options.progress = progress_of(std::move(callback));
  return options;
}

/// Of all of the time where there is no shutter.
Exposure exposure_of(const TimePicture& picture, py::handle shutter) {
  const TimeFrame& frame = picture.frame();
  Shutter chosen;
  if (shutter.is_none()) {
    chosen.open = frame.open - frame.frame_time;
    chosen.close = frame.close - frame.frame_time;
  } else {
    chosen = shutter_from(shutter);
  }
  return {chosen, frame.frame_time, frame.frame_width, frame.frame_height, frame.open, frame.close};
}

py::dict expose(const HeldTime& held, py::object shutter, bool coverage, py::object callback) {
  const Exposure exposure = exposure_of(held.picture, shutter);
  const ExposeOptions options = expose_options(coverage, std::move(callback));
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = held.picture.expose(pixel_weights(exposure), options);
  }
  return image_to(std::move(image));
}

/// (offsets, mesh, colour, coverage, depth): of pixels in rows, columns of the meshes that an exposure shows.
py::tuple objects(const HeldTime& held, py::object shutter, py::object callback) {
  const Exposure exposure = exposure_of(held.picture, shutter);
  const ExposeOptions options = expose_options(false, std::move(callback));
  ExposedObjects found;
  std::vector<int64_t> offsets;
  std::vector<uint32_t> mesh;
  std::vector<float> colour, coverage, depth;
  {
    const py::gil_scoped_release unlocked;
    found = held.picture.objects(pixel_weights(exposure), options);
    offsets.assign(found.first.begin(), found.first.end());
    for (const SeenObject& seen : found.seen) {
      mesh.push_back(seen.mesh);
      colour.insert(colour.end(), {seen.colour.x, seen.colour.y, seen.colour.z});
      coverage.push_back(seen.coverage);
      depth.push_back(seen.depth);
    }
  }
  const auto pixels = static_cast<py::ssize_t>(offsets.size()), count = static_cast<py::ssize_t>(mesh.size());
  return py::make_tuple(array_from(std::move(offsets), {pixels}), array_from(std::move(mesh), {count}),
                        array_from(std::move(colour), {count, 3}), array_from(std::move(coverage), {count}),
                        array_from(std::move(depth), {count}));
}

/// from, to: seconds from the frame's time.
py::dict flow_between(const HeldTime& held, double from, double to, py::object callback) {
  const TimeFile& file = held.with_geometry();
  FlowOptions options;
  options.progress = progress_of(std::move(callback));
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = file.flow(from, to, options);
  }
  return image_to(std::move(image));
}

std::shared_ptr<HeldShot> shot_between(const HeldTime& held, double from, double to) {
  const TimeFile& file = held.with_geometry();
  const TimeFrame& frame = held.picture.frame();
  const py::gil_scoped_release unlocked;
  return std::make_shared<HeldShot>(file.shot(frame.frame_time + from, frame.frame_time + to), frame.frame_time,
                                    frame.fps);
}

py::dict at(const HeldTime& held, double time, bool coverage) {
  if (!(time >= 0 && time <= 1)) refuse("time", "is not from 0, when the shutter opens, to 1, when it closes");
  const ExposeOptions options = expose_options(coverage, py::none());
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = held.picture.at(time, options);
  }
  return image_to(std::move(image));
}

/// (begin, end, left, right), columns of a pixel's pieces.
py::tuple signal(const HeldTime& held, int x, int y) {
  const std::vector<TimePiece> pieces = held.picture.signal(x, y);
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

py::dict about(const HeldTime& held) {
  const TimeFrame& frame = held.picture.frame();
  const TimeQuality quality = held.picture.quality();
  py::list meshes;
  for (const TimeFrame::Object& object : frame.objects) meshes.append(py::str(object.name));
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
  f("has_objects", held.picture.has_objects());
  f("has_geometry", held.has_geometry());
  f.values["mesh_names"] = meshes;
  return f.values;
}

}  // namespace

void bind_time(py::module_& module) {
  py::class_<HeldTime>(module, "TimePicture")
      .def("expose", &expose)
      .def("at", &at)
      .def("objects", &objects)
      .def("flow", &flow_between)
      .def("shot", &shot_between)
      .def("signal", &signal)
      .def("about", &about);
  module.def("record", &record);
  module.def("record_file", &record_file);
  module.def("open_time", [](const std::string& path) {
    const py::gil_scoped_release unlocked;
    return HeldTime(path);
  });
}

}  // namespace kairos::python
