// Scenes from Python's descriptions, whose arrays have been made float32 and uint32 there.
#pragma once

#include <kairos/make_scene.h>

#include "convert.h"

namespace kairos::python {

/// values: the arguments of kairos.make_scene. Refuses arrays of other shapes, and names them.
SceneDescription description_from(const py::dict& values);

}  // namespace kairos::python
