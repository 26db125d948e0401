// Textures of a glTF document: which picture, and where on it.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// Number `key` of an extension's object, or `otherwise`.
double number_in(const tinygltf::Value& object, const char* key, double otherwise);
/// Numbers of the list `key`, or `otherwise` where there is none of that length.
std::vector<double> numbers_in(const tinygltf::Value& object, const char* key, const std::vector<double>& otherwise);

/// Reads the textures of one material, which all have to lie in one way: as the first that is read.
class TextureReader {
 public:
  TextureReader(Document& document, std::string where, Scene& scene, Warnings& warnings)
      : document_(document), where_(std::move(where)), scene_(scene), warnings_(warnings) {}

  /// The path or name of the texture's picture, whose bytes join the scene if they are inside the file; empty for none.
  std::string read(const tinygltf::TextureInfo& info);
  /// The same for a texture that an extension names.
  std::string read(const tinygltf::Value& extension, const char* key);

  TexturePlace place() const { return place_.value_or(TexturePlace{}); }

 private:
  TexturePlace place_of(const tinygltf::TextureInfo& info, const tinygltf::Texture& texture);

  Document& document_;
  const std::string where_;
  Scene& scene_;
  Warnings& warnings_;
  std::optional<TexturePlace> place_;
};

}  // namespace kairos::gltf
