// What a scene holds, for those to whom it is opaque.
#include <kairos/animations.h>
#include <kairos/scene.h>
#include <kairos/scene_files.h>

#include "scene/scene.h"

namespace kairos {

SceneContents contents(const Scene& scene) {
  SceneContents result;
  for (const SceneMesh& mesh : scene.meshes)
    result.meshes.push_back({mesh.name, mesh.triangles.size(), mesh.motion->vertex_count(), mesh.material});
  for (const SceneCamera& camera : scene.cameras) {
    result.cameras.push_back({});
    static_cast<Lens&>(result.cameras.back()) = camera;
    result.cameras.back().name = camera.name;
  }
  result.materials = scene.materials;
  result.lights = scene.lights;
  for (const SceneAnimation& animation : scene.animations) result.animations.push_back(animation.name);
  for (const auto& [name, bytes] : scene.embedded_pictures) result.pictures.push_back(name);
  for (const auto& [name, pixels] : scene.pictures) result.pictures.push_back(name);
  result.background = scene.background;
  result.shutter = scene.shutter;
  result.image_size = scene.image_size;
  result.fps = scene.fps;
  result.warnings = scene.warnings;
  return result;
}

std::vector<SceneAnimation> animations(const Scene& scene) { return scene.animations; }

std::vector<std::string> files(const Scene& scene) { return scene.files; }

}  // namespace kairos
