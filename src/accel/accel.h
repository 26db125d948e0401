// Meshes -> accelerator.
#pragma once

#include <span>

#include <kairos/mesh.h>

#include "accel/layout.h"

namespace kairos {

/// Builds all trees. The meshes must be valid (validate_mesh) and are not referred to afterwards. Triangles that no key
/// moves go to the static tree, whatever the rest of their mesh does. moving_meshes_only: leaves out meshes with a
/// single key. Throws Error(bad_input) beyond 2^31 triangles.
Accel build_accel(std::span<const Mesh> meshes, bool moving_meshes_only = false);

}  // namespace kairos
