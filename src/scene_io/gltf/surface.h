// Materials, lights and cameras of a glTF document.
#pragma once

#include <optional>

#include "scene/scene.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// Adds to the scene one per material of the document, in its order, and behind them glTF's default material; also the
/// pictures inside the file that they use.
void read_materials(Document& document, Scene& scene, Warnings& warnings);

/// The lens of a camera; its motion and name are the caller's. Throws Error for one that sees nothing.
SceneCamera read_camera(const Document& document, size_t index);

/// The light that a node carries, in the node's own space; nothing where it carries none that is known.
std::optional<Light> read_light(const Document& document, int node, Warnings& warnings);

}  // namespace kairos::gltf
