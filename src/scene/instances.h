// What instances share: see Mesh::object.
#pragma once

#include <array>
#include <map>
#include <span>

#include <kairos/mesh.h>

namespace kairos {

/// Corners of the boxes that hold objects, of which what is placed is not larger than they are, placed.
class ObjectCorners {
 public:
  /// Looked up once for each object. Not for several threads.
  const std::array<Vec3f, 8>& of(const Mesh& object);

 private:
  std::map<const Mesh*, std::array<Vec3f, 8>> known_;
};

/// Corners of the box that holds a mesh at its first key; all in the origin for one without vertices.
std::array<Vec3f, 8> box_corners(const Mesh& mesh);

/// validate_mesh for each of them, with each object looked at once.
void validate_meshes(std::span<const Mesh> meshes);

}  // namespace kairos
