// Where a picture's shadows are found exactly in time.
#pragma once

#include <vector>

#include "integrators/mixed_frame.h"

namespace kairos {

/// Of time-continuous rays: [mesh]; empty for nowhere. Where RenderParams::shadows leaves it open, by a race.
std::vector<bool> choose_exact_shadows(const PixelContext& context, const Shot& shot, const RenderParams& params,
                                       const Tracer& tracer, const DiscreteScene& scene, const ShadingOptions& options,
                                       uint32_t rays_in_pixel);

/// And in which mirrors what moves is: [mesh]; empty for none. Where pixels share no light.
std::vector<bool> choose_exact_mirrors(const PixelContext& context, const RenderParams& params,
                                       const ShadingOptions& options);

/// Of mixed and auto: sets the plan's exact_shadows and still_rays_per_exact. The latter, where RenderParams::shadows
/// leaves it open, by a race between both ways in up to a hundred pixels in which nothing but shadows moves; rays of
/// races are not counted.
void choose_shadows(MixedFrame& frame, Monitor& monitor);

}  // namespace kairos
