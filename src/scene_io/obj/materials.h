// Material libraries of OBJ files (.mtl).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <kairos/scene.h>

#include "base/file.h"
#include "scene_io/file_warnings.h"

namespace kairos {

/// Adds the materials that a library's text defines, by name; the last of a name counts. docs/formats.md says what
/// becomes of its statements. Pictures are found from the library's folder, and lie in the root of `from`; one that
/// may not be read is left out with a warning, as are statements that Kairos does not know. Throws
/// Error(bad_input) that names the line of a malformed number.
void parse_mtl(std::string_view text, const std::string& path, FileWarnings& warnings,
               std::map<std::string, Material>& materials, const SceneFolder& from = {});

/// The materials of these names, from the libraries that an OBJ file at `obj_path`, in `folder`, names. A library that
/// cannot be found and a name that none defines are warnings (errors where `warnings` are), and such a material is
/// grey.
std::vector<Material> read_obj_materials(const std::string& obj_path, const SceneFolder& folder,
                                         const std::vector<std::string>& libraries,
                                         const std::vector<std::string>& names, FileWarnings& warnings);

}  // namespace kairos
