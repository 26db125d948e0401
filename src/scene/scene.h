// The scene over all of its time, as the readers of src/scene_io leave it. Plain structs.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kairos/animations.h>
#include <kairos/image.h>
#include <kairos/scene.h>

#include "scene/motion.h"
#include "scene/shared_array.h"

namespace kairos {

struct SceneMesh {
  std::string name;
  // Meshes of one shape share these arrays, and so become instances of one object: see make_shot.
  SharedArray<Triangle> triangles;           ///< indices below motion->vertex_count()
  SharedArray<Vec2f> uvs;                    ///< empty, or one per vertex: see Mesh::uvs
  SharedArray<std::vector<Vec2f>> more_uvs;  ///< see Mesh::more_uvs
  SharedArray<Vec4f> colors;                 ///< empty, or one per vertex: see Mesh::colors
  SharedArray<uint32_t> prim_ids;            ///< empty, or one per triangle: see Mesh::prim_ids
  uint32_t material = 0;                     ///< index into Scene::materials
  std::shared_ptr<const VertexMotion> motion;
};

struct SceneCamera : Lens {
  std::string name;
  std::shared_ptr<const TransformMotion> motion;  ///< world from camera, without scale; looks along -z
};

/// A light in the space of what carries it through the world.
struct MovingLight {
  Light light;
  std::shared_ptr<const TransformMotion> motion;
};

/// The light in the world where its own space is placed by `matrix`: positions and directions go along, how bright it
/// is stays.
Light placed(const Light& light, const Mat4& world_from_light);

struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<Material> materials;  ///< never empty once loaded: index 0 exists
  /// Encoded pictures that have no file of their own, by the name under which materials call them.
  std::map<std::string, std::vector<uint8_t>> embedded_pictures;
  /// The same, decoded.
  std::map<std::string, Pixels> pictures;
  std::vector<SceneCamera> cameras;
  std::vector<Light> lights;                    ///< those that move, as they are at rest
  std::map<size_t, MovingLight> moving_lights;  ///< by their places in `lights`
  /// It has lights of its own, whether or not they are read, or says that it wants none: what only glows is none.
  bool brings_lights = false;
  std::vector<SceneAnimation> animations;  ///< those the files hold, played or not
  Vec3f background{0, 0, 0};
  float brightest = std::numeric_limits<float>::infinity();  ///< see Shot
  std::optional<std::array<double, 2>> shutter;              ///< open, close in scene time; unset: see make_shot
  std::optional<std::array<int, 2>> image_size;              ///< width, height
  double fps = 24;                    ///< frames per unit of scene time, where the shutter is given in frames
  std::vector<std::string> warnings;  ///< one line each
  std::vector<std::string> notes;     ///< one line each, for the log: what was chosen for whoever did not choose
  std::vector<std::string> files;     ///< see files()
  /// Bytes that a shot of it may take, in motion keys and pictures: what loading left of LoadOptions::memory_budget. A
  /// scene from memory is trusted.
  uint64_t memory_budget = uint64_t{1} << 62;
};

}  // namespace kairos
