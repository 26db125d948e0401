// A part of the time that a shot covers.
#pragma once

#include <kairos/scene.h>

namespace kairos {

/// The shot as if its shutter were open from `begin` to `end`, shutter times with 0 <= begin < end <= 1. Without
/// normals, tangents and lights that move: for what asks where things are.
Shot cut_shot(const Shot& shot, double begin, double end);

}  // namespace kairos
