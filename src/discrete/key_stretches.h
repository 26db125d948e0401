// When the scenes of moving meshes begin and end, and which meshes share one.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <kairos/mesh.h>

#include "discrete/uniform_runs.h"

namespace kairos {

/// When the scenes of a mesh begin and end.
using Stretches = std::vector<std::pair<float, float>>;
Stretches stretches_of(const Mesh& mesh);

/// The sets of key times that have scenes of their own: those of the most triangles.
std::vector<Stretches> choose_own_sets(std::span<const Mesh> meshes);

/// Into how many pieces each key span of a run is to be cut for it to have `keys` keys.
size_t parts_per_span(UniformRun run, int keys);

}  // namespace kairos
