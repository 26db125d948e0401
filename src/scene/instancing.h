// Which meshes of a scene are one shape that is placed several times, and where it lies while the shutter is open.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/clean_triangles.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace kairos {

/// What instances have in common. Its vertices are relative to their middle, so that where they lie in a file costs no
/// digits.
struct SharedObject {
  std::shared_ptr<const Mesh> mesh;
  Vec3d middle;                  ///< in the shape's own space
  std::array<Vec3f, 8> corners;  ///< of the box around the vertices, relative to the middle
  DroppedTriangles dropped;
  std::vector<size_t> meshes;  ///< of the scene: its instances
};

/// Groups the meshes that share a shape, where that is worth it: for a frame of so many pixels, if the choice is
/// automatic. Empty where none is.
std::vector<SharedObject> find_shared_objects(const Scene& scene, ShotOptions::Instances choice, uint64_t pixels);

/// The instance that takes the place of a mesh; excess: see MotionKeys. None where at some key the object is flat, or
/// nearly: discrete rays could not be told where they meet it.
std::optional<Mesh> make_instance(const SceneMesh& source, const SharedObject& object, const View& view,
                                  double tolerance, uint64_t keys_at_most, double& excess);

}  // namespace kairos
