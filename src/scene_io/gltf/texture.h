// Textures of a glTF document: which picture, and where it lies.
#pragma once

#include <string>

#include "scene/scene.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// Number `key` of an extension's object, or `otherwise`.
double number_in(const tinygltf::Value& object, const char* key, double otherwise);
/// Numbers of the list `key`, or `otherwise` where there is none of that length.
std::vector<double> numbers_in(const tinygltf::Value& object, const char* key, const std::vector<double>& otherwise);

/// So many sets of texture coordinates may a mesh have.
inline constexpr uint32_t kMostUvSets = 8;

/// Reads the textures of one material.
class TextureReader {
 public:
  TextureReader(Document& document, std::string where, Scene& scene, Warnings& warnings)
      : document_(document), where_(std::move(where)), scene_(scene), warnings_(warnings) {}

  /// The texture's picture, whose bytes join the scene if they are inside the file, and how it lies; empty for none.
  /// Info: tinygltf::TextureInfo or one of its kinds for normals and occlusion.
  template <class Info>
  TextureRef read(const Info& info) {
    return read(info.index, info.texCoord, info.extensions);
  }
  /// The same for a texture that an extension names.
  TextureRef read(const tinygltf::Value& extension, const char* key);

 private:
  TextureRef read(int index, int uv_set, const tinygltf::ExtensionMap& extensions);
  void place(int uv_set, const tinygltf::ExtensionMap& extensions, TextureRef& texture);

  Document& document_;
  const std::string where_;
  Scene& scene_;
  Warnings& warnings_;
};

}  // namespace kairos::gltf
