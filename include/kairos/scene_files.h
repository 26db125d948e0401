// Which files a scene is made of.
#pragma once

#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/scene.h>

namespace kairos {

/// Those that load_scene was given, in their order, and then those that they name, sorted: what they include, buffers,
/// materials, pictures, whether a shot needs them or not, and whether they are there or not. None of a scene from
/// memory.
KAIROS_API std::vector<std::string> files(const Scene& scene);

}  // namespace kairos
