// Reads the pictures that a scene's materials name.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/memory_budget.h"
#include "scene/scene.h"

namespace kairos {

/// What pictures take comes out of `budget`, to which their files add what they bear out; one that does not fit counts
/// as one that cannot be read.
///
/// [material]; the pictures of those that a mesh has, each read once, however many materials use it. One that cannot be
/// read is left out with a note, as one is on meshes without the coordinates it takes; with `strict` both throw
/// Error(io) or Error(bad_input). cut_outs_only: none but those with the alpha of what is cut out or blended. Empty
/// when there is nothing to read.
std::vector<MaterialTextures> load_textures(const Scene& scene, bool cut_outs_only, bool strict, MemoryBudget& budget,
                                            std::vector<std::string>& notes);

/// [light], of lights of the scene; null for those without a picture that can be read. Notes and errors as above.
std::vector<std::shared_ptr<const Texture>> load_light_textures(const Scene& scene, std::span<const Light> lights,
                                                                bool strict, MemoryBudget& budget,
                                                                std::vector<std::string>& notes);

}  // namespace kairos
