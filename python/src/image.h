// Images to Python's dicts and back.
#pragma once

#include <kairos/image.h>

#include "convert.h"

namespace kairos::python {

/// What kairos.Image is made of. The arrays of channels take the image's memory.
py::dict image_to(Image image);
Image image_from(const py::dict& values);

}  // namespace kairos::python
