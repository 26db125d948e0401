// The parts of the module, each of which adds what it binds.
#pragma once

#include "convert.h"

namespace kairos::python {

void bind_scene(py::module_& module);
void bind_render(py::module_& module);
void bind_tracer(py::module_& module);
void bind_time(py::module_& module);
void bind_flow(py::module_& module);
void bind_events(py::module_& module);

}  // namespace kairos::python
