// Pieces of read_model.
#pragma once

#include "scene_io/gltf/file_model.h"
#include "scene_io/gltf/members.h"

namespace kairos::gltf::file {

Material read_material(Members& material, Warnings& warnings);

}  // namespace kairos::gltf::file
