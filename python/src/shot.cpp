#include "shot.h"

namespace kairos::python {

HeldShot::HeldShot(std::shared_ptr<const Scene> scene, ShotOptions options, std::optional<Vec3f> backdrop,
                   bool transparent, std::optional<Shutter> shutter)
    : scene_(std::move(scene)),
      options_(std::move(options)),
      backdrop_(backdrop),
      transparent_(transparent),
      shutter_(std::move(shutter)) {
  const SceneContents held = contents(*scene_);
  fps_ = options_.fps.value_or(held.fps);
  frame_time_ = options_.frame.value_or(0) / fps_;
  if (shutter_) {
    const auto size = held.image_size.value_or(std::array<int, 2>{Projection().width, Projection().height});
    const int width = options_.width > 0 ? options_.width : size[0];
    const int height = options_.height > 0 ? options_.height : size[1];
    const ExposureInterval whole = whole_interval(*shutter_, width, height);
    options_.shutter = {whole.open * fps_, whole.close * fps_};
    options_.frame = options_.frame.value_or(0);
    if (!(whole.open < whole.close)) shutter_.reset();  // all pixels see one instant
  }
  shot_ = make(options_);
}

Shot HeldShot::make(const ShotOptions& options) const {
  Shot shot = make_shot(*scene_, options);
  if (backdrop_) shot.backdrop = backdrop_;
  return shot;
}

const Shot& HeldShot::shot_for(ShadingKind shading) const {
  if (scene_ == nullptr) return shot_;
  const bool lent = options_.lights == LightChoice::automatic && shot_.lights.size() > contents(*scene_).lights.size();
  if (is_lit(shading) || !lent) return shot_;
  const std::lock_guard lock(mutex_);
  if (!unlit_) {
    ShotOptions options = options_;
    options.lights = LightChoice::file;
    unlit_ = std::make_unique<const Shot>(make(options));
  }
  return *unlit_;
}

std::optional<Exposure> HeldShot::exposure() const {
  if (!shutter_) return std::nullopt;
  return Exposure(*shutter_, frame_time_, shot_.projection.width, shot_.projection.height, shot_.shutter_open,
                  shot_.shutter_close);
}

Shutter shutter_from(py::handle value) {
  Shutter shutter;
  Reader reader("Shutter", py::dict(value.attr("__dict__")));
  reader("open", shutter.open);
  reader("close", shutter.close);
  reader("open_line", shutter.open_line);
  reader("close_line", shutter.close_line);
  reader("scan", shutter.scan);
  reader("first_line", shutter.first_line);
  reader("normalise", shutter.normalise);
  const py::object curve = value.attr("curve");
  if (!curve.is_none()) {
    const auto array = array_of<double>("curve", curve, {-1, 2});
    shutter.curve = TimeWeight(rows_of<TimeWeight::Point>(array.data(), static_cast<size_t>(array.shape(0))));
  }
  return shutter;
}

Progress progress_of(py::object callback) {
  // Whoever destroys the last copy of the object needs Python's lock.
  const std::shared_ptr<py::object> held(new py::object(std::move(callback)), [](py::object* object) {
    const py::gil_scoped_acquire lock;
    delete object;
  });
  return [held](double fraction) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (held->is_none()) return true;
    const py::object answer = (*held)(fraction);
    return !answer.is(py::bool_(false));
  };
}

}  // namespace kairos::python
