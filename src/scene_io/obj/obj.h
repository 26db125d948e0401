// Wavefront OBJ: polygons, normals and texture coordinates.
#pragma once

#include <string>
#include <string_view>

#include "scene_io/mesh_data.h"

namespace kairos {

/// Reads v, vt, vn and f; all objects and groups become one mesh; other statements (materials, lines, free-form
/// surfaces, ...) and further numbers after the ones needed are passed over. `path` is for messages. An index that
/// names nothing becomes kBadIndex. Throws Error(bad_input) that names the line of a malformed statement.
PolygonMesh parse_obj(std::string_view text, const std::string& path);

}  // namespace kairos
