// Does everything move together?
#pragma once

#include <optional>

#include <kairos/scene.h>

namespace kairos {

/// Where all light on all surfaces is the same while the shutter is open, by how many pixels these move meanwhile:
/// the median over some vertices of each mesh. So it is where nothing moves but the camera, or, in light from
/// infinitely far and of surfaces alone, where all is shifted by the same way. Nothing where it is not so, as judged by
/// the same vertices at some instants, to a quarter of a pixel.
std::optional<double> common_motion(const Shot& shot);

}  // namespace kairos
