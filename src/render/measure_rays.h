// What rays of a shot cost, by the processor's clock.
#pragma once

#include "integrators/integrator.h"

namespace kairos {

/// See Renderer::calibrate. On the calling thread.
Calibration measure_rays(ShotParts& parts, const RenderParams& params, const Progress& progress);

}  // namespace kairos
