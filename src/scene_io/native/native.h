// Kairos' own scene file (JSON): key-frame sequences, camera motion, and other files put together.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"
#include "scene_io/load.h"

namespace kairos {

/// Reads the file at `path` and the files it names, which must lie in its folder or below.
///
/// What the format leaves open: the name of a mesh is by default that of its first key; `up` of a camera key is by
/// default [0, 1, 0]; `time` of transform and camera keys may be left out of all keys of a list, and they are then
/// spread evenly over [0, 1]; a single transform may stand without its list; `alpha_cutoff` makes a material a mask,
/// `alpha` and `alpha_texture` without it something blended. Light fields: point: position, intensity; directional:
/// direction (in which it travels), irradiance; constant: radiance. Without `shutter` the first included file that has
/// one gives it, else it is [0, 1] where something in this file has several keys. One frame is one unit of time, unless
/// an included file says otherwise. Throws Error(bad_input), naming file and JSON path, or Error(io).
Scene load_native(const std::string& path, LoadContext& context);

/// The same for a file that is in memory already; `path` tells where it lies.
Scene parse_native(std::string_view text, const std::string& path, LoadContext& context);

}  // namespace kairos
