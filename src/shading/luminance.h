#pragma once

#include <kairos/vec.h>

namespace kairos {

/// Of linear colours with the primaries of Rec. 709.
inline float luminance(Vec3f c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace kairos
