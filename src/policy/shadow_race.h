// On which meshes shadows are worth being found exactly in time.
#pragma once

#include <cstdint>
#include <vector>

#include <kairos/tracer.h>

#include "shading/pixel_context.h"
#include "shading/spread.h"

namespace kairos {

/// receivers: [mesh], of Shader::resting_receivers(). Of those, the ones on which exact shadows have the smaller
/// product of error and time, by looks at a few hundred pixels of the frame: the same for any crop, and no clock is
/// asked. options: of the picture's rays, of which each pixel has about so many.
std::vector<bool> race_shadows(const PixelContext& context, const Shot& shot, ShadingKind shading, const Tracer& tracer,
                               const DiscreteScene& scene, const ShadingOptions& options, uint32_t rays_in_pixel,
                               std::vector<bool> receivers);

}  // namespace kairos
