// Light for scenes that bring none: docs/light.md.
#pragma once

#include <kairos/scene.h>

#include "math/transform.h"

namespace kairos {

/// What is seen from an eye in all directions, roughly.
struct Surroundings {
  double open = 1;      ///< the part of all directions from which light can come from afar
  double distance = 1;  ///< to what is nearest in the others: the median; 1 where there are none
};

/// Every mesh as it is at its first key. Panes, cut-outs and the backs of one-sided surfaces let light pass.
Surroundings look_around(const Shot& shot, Vec3d eye);

/// Gives a shot that has neither textures of lights nor lights of its own the studio's: a soft environment (unless
/// `environment` is false) and a key light from behind the left shoulder of a camera that is placed so, turned about
/// the vertical alone; or, where `around` is as good as closed, a light at the eye.
void add_studio(Shot& shot, const Mat4& world_from_camera, const Surroundings& around, bool environment);

/// Fewer open directions than this, and the key light is at the eye.
inline constexpr double kLeastOpen = 0.125;

}  // namespace kairos
