// Optical flow.
#include <kairos/flow.h>

#include "bindings.h"
#include "image.h"
#include "shot.h"

namespace kairos::python {

namespace {

py::dict flow_of(const HeldShot& held, const py::dict& values, py::object callback) {
  FlowOptions options;
  Reader reader("flow", values);
  reader("backward", options.backward);
  reader("instruction_set", options.instruction_set);
  reader("threads", options.threads);
  reader.finish();
  options.progress = progress_of(std::move(callback));
  Image image;
  {
    const py::gil_scoped_release unlocked;
    image = flow(held.shot(), options);
  }
  return image_to(std::move(image));
}

void write(const py::dict& values, const std::string& path) {
  const Image image = image_from(values);
  const py::gil_scoped_release unlocked;
  write_flow(image, path);
}

}  // namespace

void bind_flow(py::module_& module) {
  module.def("flow", &flow_of);
  module.def("write_flow", &write);
}

}  // namespace kairos::python
