// Meshes compressed with Draco (KHR_draco_mesh_compression).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <draco/mesh/mesh.h>

#include "scene_io/gltf/document.h"

namespace kairos::gltf {

class DracoMesh {
 public:
  /// Decodes `bytes`. Throws Error at `where` when they are no Draco mesh, or one with other than `points` points and
  /// (unless that is 0, for not known) `corners` / 3 triangles: the counts of the accessors that it stands for.
  DracoMesh(Document& document, std::span<const uint8_t> bytes, uint64_t points, uint64_t corners,
            const std::string& where);

  /// Three per triangle; not checked against the number of points.
  std::vector<uint32_t> indices(Document& document) const;

  /// [point][component] of the attribute with this unique id, as read_floats of gltf_accessor.h gives them.
  std::vector<float> floats(Document& document, uint32_t id, int components, bool normalized) const;

 private:
  std::string where_;
  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace kairos::gltf
