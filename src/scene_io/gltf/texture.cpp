#include "scene_io/gltf/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace kairos::gltf {

namespace {

constexpr double kMostTurns = 1e6;  // radians; beyond, a float's sine is noise

/// Of a placement: within what products of floats can take.
float coefficient(double value) {
  constexpr double kMost = 1e18;
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

TextureWrap wrap_of(int code) {
  constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648;
  return code == kClampToEdge      ? TextureWrap::clamp
         : code == kMirroredRepeat ? TextureWrap::mirror
                                   : TextureWrap::repeat;
}

/// The extension says that coordinates turn counter-clockwise; with v downwards, as glTF has it, that is this way
/// round. (The formula in its text turns the other way; viewers and exporters agree on this one.)
std::array<Vec3f, 2> placement_of(const file::TextureTransform& transform) {
  const double rotation = std::clamp(transform.rotation, -kMostTurns, kMostTurns);
  const double cosine = rotation == 0 ? 1 : std::cos(rotation), sine = rotation == 0 ? 0 : std::sin(rotation);
  const auto &scale = transform.scale, &offset = transform.offset;
  return {Vec3f{coefficient(cosine * scale[0]), coefficient(sine * scale[1]), coefficient(offset[0])},
          Vec3f{coefficient(-sine * scale[0]), coefficient(cosine * scale[1]), coefficient(offset[1])}};
}

/// A picture's path, or the name under which its bytes join the scene. Throws Error for one that is nowhere that may be
/// read.
std::string find_picture(Document& document, size_t index, Scene& scene) {
  const file::Image& image = document.model.images[index];
  const std::string where = at("images", index);
  std::string name = document.name + ": " + where;
  if (scene.embedded_pictures.count(name)) return name;
  const auto embed = [&](std::span<const uint8_t> bytes) {
    document.charge(bytes.size(), where);
    scene.embedded_pictures.emplace(name, std::vector<uint8_t>(bytes.begin(), bytes.end()));
    return name;
  };
  if (is_data_uri(image.uri)) return embed(decode_data_uri(image.uri, name));
  if (!image.uri.empty()) {
    if (document.folder.path.empty()) return "";
    return path_of_uri(document, image.uri, where);
  }
  if (image.bufferView < 0) document.fail(where, "has neither a uri nor a bufferView");
  if (static_cast<size_t>(image.bufferView) >= document.model.bufferViews.size())
    document.fail(where, fmt::format("names buffer view {}, but there are {}", image.bufferView,
                                     document.model.bufferViews.size()));
  const uint64_t length = document.model.bufferViews[static_cast<size_t>(image.bufferView)].byteLength;
  return embed(document.view_bytes(image.bufferView, 0, length, where));
}

/// The same; empty, with a warning, for a picture that cannot be read: the shapes are right without it.
std::string picture_of(Document& document, size_t index, Scene& scene, Warnings& warnings) {
  try {
    return find_picture(document, index, scene);
  } catch (const Error& error) {
    const std::string prefix = document.name + ": ", what = error.what();
    warnings.add("", "a picture is left out: " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
    return "";
  }
}

}  // namespace

TextureRef read_texture(Document& document, const file::TextureInfo& info, const std::string& where, Scene& scene,
                        Warnings& warnings) {
  if (info.index < 0) return {};
  const auto& textures = document.model.textures;
  if (static_cast<size_t>(info.index) >= textures.size())
    document.fail(where, fmt::format("names texture {}, but there are {}", info.index, textures.size()));
  const file::Texture& texture = textures[static_cast<size_t>(info.index)];
  const std::string texture_where = at("textures", static_cast<size_t>(info.index));
  if (texture.source < 0) {
    warnings.add(texture_where, texture.encoding.empty() ? "a texture without an image is left out"
                                                         : "pictures in " + texture.encoding +
                                                               " are left out; convert them to PNG, JPEG or WebP");
    return {};
  }
  if (static_cast<size_t>(texture.source) >= document.model.images.size())
    document.fail(texture_where,
                  fmt::format("names image {}, but there are {}", texture.source, document.model.images.size()));
  if (info.texCoord < 0 || info.texCoord >= static_cast<int>(kMostUvSets)) {
    warnings.add(where, fmt::format("textures that take other texture coordinates than sets 0 to {} are left out",
                                    kMostUvSets - 1));
    return {};
  }
  TextureRef result;
  result.nearest = std::nullopt;  // what glTF calls "auto filtering"
  result.picture = picture_of(document, static_cast<size_t>(texture.source), scene, warnings);
  result.uv_set = static_cast<uint32_t>(info.texCoord);
  if (info.transform) result.placement = placement_of(*info.transform);
  const auto& samplers = document.model.samplers;
  if (texture.sampler >= 0 && static_cast<size_t>(texture.sampler) < samplers.size()) {
    const file::Sampler& sampler = samplers[static_cast<size_t>(texture.sampler)];
    result.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
    result.nearest = sampler.nearest;
  }
  return result;
}

}  // namespace kairos::gltf
