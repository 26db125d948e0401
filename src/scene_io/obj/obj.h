// Wavefront OBJ: polygons, normals, texture coordinates, colours of vertices, and which material each face has.
#pragma once

#include <string>
#include <string_view>

#include "scene_io/mesh_data.h"

namespace kairos {

/// Reads v, vt, vn, f, usemtl and mtllib (the names alone: see materials.h); all objects and groups become one mesh.
/// Other statements (lines, free-form surfaces, ...) are left out with a warning, and so are smoothing groups where
/// there are no normals; numbers after the ones needed are passed over, but for a vertex's colour. `path` is for
/// messages. An index that names nothing becomes kBadIndex. Throws Error(bad_input) that names the line of a malformed
/// statement.
PolygonMesh parse_obj(std::string_view text, const std::string& path);

}  // namespace kairos
