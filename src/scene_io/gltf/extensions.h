// The extensions of glTF that the reader knows.
#pragma once

#include <string>
#include <vector>

#include "scene_io/gltf/warnings.h"

namespace kairos::gltf {

/// Throws Error(bad_input, "name: extensionsRequired") for an extension that a file cannot do without and that is not
/// read, and warns of those it uses that are not even known. What becomes of the others is said where they are read.
void check_extensions(const std::vector<std::string>& required, const std::vector<std::string>& used,
                      const std::string& name, Warnings& warnings);

}  // namespace kairos::gltf
