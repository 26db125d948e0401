// Mixed and auto look at pixels all over the frame, for where which rays are needed.
#pragma once

#include "integrators/mixed_frame.h"

namespace kairos {

/// Sets the plan's allotment, race and spread, where the picture is to have them and is large enough. Adds what it
/// traces to `stats`, except for the rays of races: they would not be those of the picture.
void look_around(MixedFrame& frame, Monitor& monitor, RenderStats& stats);

}  // namespace kairos
