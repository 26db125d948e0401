// PLY (Stanford polygon files): polygons or triangle strips, normals, texture coordinates and colours of vertices.
#pragma once

#include <string>
#include <string_view>

#include "scene_io/mesh_data.h"

namespace kairos {

/// Reads ascii, binary little-endian and binary big-endian files. Of the element `vertex` x y z, nx ny nz, and as
/// texture coordinate u v, s t, texture_u texture_v or texture_s texture_t; of `face` the list vertex_indices (or
/// vertex_index), of `tristrips` the same, where -1 begins another strip; of `vertex` also red green blue and alpha
/// (also diffuse_red, ...), in codes of sRGB. All else is left out with a warning. `path` is for messages. An index
/// that cannot name a vertex becomes kBadIndex. Throws Error(bad_input) for a malformed or truncated file.
PolygonMesh parse_ply(std::string_view file, const std::string& path);

}  // namespace kairos
