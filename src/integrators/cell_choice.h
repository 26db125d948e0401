// Whether light is shared through cells of surfaces, and how large these are.
#pragma once

#include <optional>

#include "base/monitor.h"
#include "discrete/discrete_scene.h"
#include "shading/pixel_context.h"
#include "shading/surface_cells.h"

namespace kairos {

struct CellChoice {
  std::optional<CellOptions> cells;
  /// Squared error of the light of a pixel, in the mean, as if surfaces were as bright as Shader::unlit_colour has
  /// them; 0: unknown.
  double light_error = 0;
};

/// Of a picture with about so many look-ups in each pixel. No cells where light is not to be shared: it is not wanted,
/// there is none that could be, or cells of no size are clearly nearer to the truth than light that every look-up asks
/// for itself.
///
/// Raced in a few squares of pixels all over the frame, with the same result for any crop; no clock is asked. Discrete
/// rays stand for all kinds: what differs between them is what is seen, and not the light on it. Of one pixel in
/// sixteen of the squares, what is looked up is shaded alone, twice, by random numbers of its own. With A what the
/// pixel shows by cells, U1 and U2 what it shows by these, (A - U1)(A - U2) is the squared error of A in the mean, bias
/// and noise, and (U1 - U2)^2 / 2 that of light asked for alone: the same rays see the same surfaces in all three.
/// docs/method.md, "Surface cells".
CellChoice choose_cells(const PixelContext& context, const Shot& shot, const RenderParams& params,
                        const DiscreteScene& scene, double look_ups, Monitor& monitor);

}  // namespace kairos
