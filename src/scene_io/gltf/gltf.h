// glTF 2.0 and GLB files as scenes. Scene time is glTF's: seconds.
//
// What is read: the scene graph (TRS and matrices), animations, skins, morph targets, sparse and quantised accessors,
// Draco, triangle lists, strips and fans, cameras, materials' factors and base colour texture, point and directional
// lights. Each primitive of each node becomes one SceneMesh. Outside of an animation's range its first or last value
// holds. A node whose rest pose (the file's own TRS, without animation) mirrors has its triangles turned round, as the
// specification asks, so that front stays front; so do the vertices of a skin whose first joint mirrors at rest.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <kairos/scene.h>

#include "scene/scene.h"
#include "scene_io/load.h"

namespace kairos {

/// Throws Error(bad_input) or Error(io) with one line that says where, such as "file.gltf: accessors[3]".
Scene load_gltf(const std::string& path, LoadContext& context);

/// The same from memory. `name` stands for the file in messages; other files are looked up from `folder`, and are
/// refused when its path is empty.
Scene parse_gltf(std::span<const uint8_t> bytes, const std::string& name, const SceneFolder& folder,
                 LoadContext& context);
Scene parse_gltf(std::span<const uint8_t> bytes, const std::string& name, const std::string& folder,
                 const LoadOptions& options = {});

}  // namespace kairos
