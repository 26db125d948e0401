// pbrt scene files, as pbrt-v3 and pbrt-v4 have them.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"
#include "scene_io/load.h"

namespace kairos {

/// Triangles of a pbrt scene, all of its instances counted: 3 GiB of indices.
inline constexpr uint64_t kMaxPbrtTriangles = uint64_t{1} << 28;

/// Reads the file at `path` and those it names, which must lie in its folder or below. docs/pbrt.md says what is read
/// and how. What cannot be kept, and files that are not there, are warnings (with LoadOptions::strict: an Error); text
/// that is malformed is an Error(bad_input) that names file and line.
///
/// World units and coordinates are the file's; a left-handed world, as pbrt's cameras make it unless they mirror, is
/// mirrored in x, so that the picture comes out as pbrt's. Texture coordinates count from an image's upper left corner.
Scene load_pbrt(const std::string& path, LoadContext& context);

/// The same for a file that is in memory already; `path` tells where it lies.
Scene parse_pbrt(std::string_view text, const std::string& path, LoadContext& context,
                 uint64_t max_triangles = kMaxPbrtTriangles);

}  // namespace kairos
