// Many copies of a node's mesh (EXT_mesh_gpu_instancing).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "math/transform.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// Where each copy stands in the node's space. attributes: names and accessors, as the extension has them. Throws Error
/// for accessors that cannot be read, or have not the same number of elements.
std::vector<Mat4> read_instances(Document& document, const std::map<std::string, int>& attributes,
                                 const std::string& where, Warnings& warnings);

}  // namespace kairos::gltf
