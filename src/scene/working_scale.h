// Scenes of any size: geometry is traced at a size at which products of coordinates neither overflow nor vanish.
//
// Kernels work in single precision and multiply up to six lengths. Multiplied by a power of two, everything is the same
// bits but for the exponent, so scenes far from the size of everyday things are scaled on their way in and distances
// on their way out; all others are taken as they are.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <kairos/mesh.h>
#include <kairos/tracer.h>

namespace kairos {

/// Positions are to be multiplied by two to this power; 0 for most scenes. From the geometric mean of the vertices'
/// largest coordinates, so that a few that are far away decide nothing.
int working_exponent(std::span<const Mesh> meshes);

/// Copies of the meshes, so multiplied; without what tracing has no use for.
std::vector<Mesh> scaled_copies(std::span<const Mesh> meshes, int exponent);

/// Asks about holes in scaled geometry what is known of the geometry that was given. Null for null.
std::shared_ptr<const CutOuts> scaled_cut_outs(std::shared_ptr<const CutOuts> cut_outs, int exponent);

}  // namespace kairos
