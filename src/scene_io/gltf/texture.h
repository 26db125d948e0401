// Textures of a glTF document: which picture, and where it lies.
#pragma once

#include <string>

#include "scene/scene.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// So many sets of texture coordinates may a mesh have.
inline constexpr uint32_t kMostUvSets = 8;

/// The texture's picture, whose bytes join the scene if they are inside the file, and how it lies; empty for none, or
/// for one that is left out with a warning. Throws Error at `where` for a texture that does not exist.
TextureRef read_texture(Document& document, const file::TextureInfo& info, const std::string& where, Scene& scene,
                        Warnings& warnings);

}  // namespace kairos::gltf
