// From a picture's colours to those of a screen.
#pragma once

#include <kairos/image.h>
#include <kairos/vec.h>

namespace kairos {

/// Up to this the filmic view leaves a colour's largest component as it is.
inline constexpr double kShoulderBegin = 0.7;

/// The filmic view of a brightness: itself up to kShoulderBegin, then along a hyperbola that goes on in the same
/// direction and never reaches 1. docs/light.md derives it. value: 0 or more, infinity too.
double filmic_shoulder(double value);

/// The colour on a screen, linear, 0 to 1, of a linear one. Not finite or negative components count as 0, but for
/// infinite ones, which are as bright as can be.
Vec3f seen_on_screen(Vec3f colour, ViewTransform view, double exposure);

}  // namespace kairos
