// Meshes of several materials as several meshes.
#pragma once

#include <vector>

#include "scene_io/mesh_data.h"

namespace kairos {

/// The triangles of one material, and the vertices that they use.
struct MaterialPart {
  uint32_t material = 0;  ///< index into the mesh's material_names
  MeshData data;          ///< without names and warnings; its prim_ids count the triangles of the whole mesh
};

/// One part for each material that some triangle has, in order of materials; a mesh without triangles stays one part.
std::vector<MaterialPart> split_by_material(MeshData mesh);

}  // namespace kairos
