// What rays of a shot cost, by the processor's clock.
#pragma once

#include "integrators/integrator.h"

namespace kairos {

/// How often measure_rays() tells its monitor that it has done a part: "pixels" of it.
inline constexpr uint64_t kMeasuringSteps = 60;

/// See Renderer::calibrate. On the calling thread.
Calibration measure_rays(ShotParts& parts, const RenderParams& params, Monitor& monitor);

}  // namespace kairos
