// What rays of a shot cost, by the processor's clock.
#pragma once

#include <span>
#include <vector>

#include "integrators/integrator.h"

namespace kairos {

/// A way to render a pixel.
struct MeasuredWay {
  IntegratorKind integrator;  ///< qmc or mixed
  int tc_rays, spp;           ///< see RenderParams
};
/// Nanoseconds that a pixel takes of this thread's processor time, for each way: of pixels in which something moves or,
/// of others, where it is said so. Empty where there are none. The same params as measure_rays() takes; tells the
/// monitor of `rounds` parts for each way.
std::vector<double> measure_pixels(ShotParts& parts, const RenderParams& params, std::span<const MeasuredWay> ways,
                                   bool moving, int rounds, Monitor& monitor);

/// How often measure_rays() tells its monitor that it has done a part: "pixels" of it.
inline constexpr uint64_t kMeasuringSteps = 60;

/// See Renderer::calibrate. On the calling thread.
Calibration measure_rays(ShotParts& parts, const RenderParams& params, Monitor& monitor);

}  // namespace kairos
