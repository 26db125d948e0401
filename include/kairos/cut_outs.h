// What a shot's pictures cut out of its surfaces, for a Tracer.
#pragma once

#include <memory>

#include <kairos/export.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos {

/// Surfaces are missing where their alpha is below the cut-off (Material::alpha_cutoff), as in pictures; blended ones
/// are whole. For TracerOptions::cut_outs, with the shot's meshes. Reads the shot, which must outlive it.
KAIROS_API std::shared_ptr<const CutOuts> cut_outs_of(const Shot& shot);

}  // namespace kairos
