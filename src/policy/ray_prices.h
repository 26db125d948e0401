// What rays cost: measured once for a shot, or from counts of their work. Either are recorded numbers instead of
// clocks, so that a picture is the same every time.
#pragma once

#include <cstddef>

#include <kairos/render.h>

#include "motion/motion_mask.h"
#include "shading/pixel_context.h"
#include "shading/spread.h"

namespace kairos {

/// Of one of `rays` time-continuous rays in a pixel: on straight lines over the logarithm of their number.
double tc_ray_price(const RayPrices& prices, double rays);

/// Throws Error(bad_usage) for times that nothing takes.
RayPrices prices_of(const Calibration& calibration);

/// Means over time-continuous rays through pixels in which something moves.
struct RayWork {
  double nodes = 0, triangles = 0, hits = 0;  ///< see TraceCounters
  double evaluations = 0;                     ///< of the shader
};

/// Traces and shades a few hundred rays, spread over the pixels that the mask names. Zero work where there are none.
RayWork sample_ray_work(const PixelContext& context, const Shot& shot, const MotionMask& mask, const Tracer& tracer,
                        const ShadingOptions& options);

/// Nanoseconds for so much work of time-continuous rays, see TraceCounters; only their ratios matter.
double tracing_time(double nodes, double triangles, double hits);

/// key_spans: see mean_key_spans. anything_still: does any mesh have a single key?
RayPrices estimate_prices(const RayWork& work, double key_spans, bool anything_still, ShadingKind shading);

/// Mean number of key spans of the moving meshes' triangles; at least 1.
double mean_key_spans(const Shot& shot);

}  // namespace kairos
