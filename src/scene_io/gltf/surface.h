// Materials, lights and cameras of a glTF document.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// Adds to the scene one per material of the document, in its order, and behind them glTF's default material; also the
/// pictures inside the file that they use.
void read_materials(Document& document, Scene& scene, Warnings& warnings);

/// The lens of a camera; its motion and name are the caller's. Throws Error for one that sees nothing.
SceneCamera read_camera(const Document& document, size_t index);

/// The lights of `nodes` in the order given. They do not move: `world[i]` places nodes[i].
std::vector<Light> read_lights(const Document& document, const std::vector<int>& nodes, const std::vector<Mat4>& world,
                               Warnings& warnings);

}  // namespace kairos::gltf
