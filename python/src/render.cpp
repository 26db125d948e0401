// Pictures of shots.
#include <map>
#include <mutex>

#include <kairos/compare.h>
#include <kairos/render.h>

#include "bindings.h"
#include "image.h"
#include "params.h"
#include "shot.h"

namespace kairos::python {

namespace {

/// Trees are kept for the next picture. From several threads: one picture at a time.
class HeldRenderer {
 public:
  explicit HeldRenderer(std::shared_ptr<HeldShot> shot) : shot_(std::move(shot)) {
    if (shot_->options().space == ShotOptions::Space::world)
      refuse("shot", "is in world space, for a Tracer; pictures are made in the camera's: Scene.shot(space='camera')");
  }

  py::tuple render(const py::dict& values, py::object callback) {
    const RenderParams params = render_params(*shot_, values);
    const Progress progress = progress_of(std::move(callback));
    RenderStats stats;
    Image image;
    {
      const py::gil_scoped_release unlocked;
      const std::lock_guard lock(mutex_);
      image = of(params.shading).render(params, &stats, progress);
    }
    return py::make_tuple(image_to(std::move(image)), stats_to(stats));
  }

  py::dict calibrate(const py::dict& values, py::object callback) {
    const RenderParams params = render_params(*shot_, values);
    const Progress progress = progress_of(std::move(callback));
    Calibration measured;
    {
      const py::gil_scoped_release unlocked;
      const std::lock_guard lock(mutex_);
      measured = of(params.shading).calibrate(params, progress);
    }
    Writer writer;
    calibration_fields(writer, measured);
    return writer.values;
  }

 private:
  Renderer& of(ShadingKind shading) {
    const Shot& shot = shot_->shot_for(shading);
    return renderers_.try_emplace(&shot, shot).first->second;
  }

  std::shared_ptr<HeldShot> shot_;
  std::mutex mutex_;
  std::map<const Shot*, Renderer> renderers_;
};

void write_picture(const py::dict& values, const std::string& path, bool half, const std::string& view,
                   double exposure) {
  const Image image = image_from(values);
  WriteOptions options;
  options.half = half;
  read("view", py::str(view), options.view);
  options.exposure = exposure;
  const Progress go_on = progress_of(py::none());
  options.go_on = [&] { return go_on(0); };
  const py::gil_scoped_release unlocked;
  write_image(image, path, options);
}

py::dict read_picture(const std::string& path) {
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = read_image(path);
  }
  return image_to(std::move(image));
}

}  // namespace

void bind_render(py::module_& module) {
  py::class_<HeldRenderer>(module, "Renderer")
      .def(py::init<std::shared_ptr<HeldShot>>())
      .def("render", &HeldRenderer::render)
      .def("calibrate", &HeldRenderer::calibrate);
  module.def("default_params", [] {
    Writer writer;
    const RenderParams defaults;
    render_fields(writer, defaults);
    return writer.values;
  });
  module.def("default_material", [] {
    Writer writer;
    const Material defaults;
    material_fields(writer, defaults);
    return writer.values;
  });
  module.def("shows_light", [](const HeldShot& held) { return reflects_light(held.shot()); });
  module.def("write_image", &write_picture);
  module.def("read_image", &read_picture);
  module.def("difference", [](const py::dict& reference, const py::dict& image) {
    const Difference found = difference(image_from(reference), image_from(image), "image");
    return py::make_tuple(found.mse, found.psnr);
  });
}

}  // namespace kairos::python
