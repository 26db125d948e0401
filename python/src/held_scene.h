// A scene as Python holds it.
#pragma once

#include <memory>

#include <kairos/scene.h>

namespace kairos::python {

/// Scene is opaque, and Python needs a whole type.
struct HeldScene {
  std::shared_ptr<const Scene> scene;
};

}  // namespace kairos::python
