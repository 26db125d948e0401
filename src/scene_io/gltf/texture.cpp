#include "scene_io/gltf/texture.h"

#include <algorithm>
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

std::span<const uint8_t> picture_bytes(const Document& document, const ImageSource& source) {
  if (source.buffer_view < 0) return source.bytes;
  const auto index = static_cast<size_t>(source.buffer_view);
  if (index >= document.model.bufferViews.size())
    document.fail(source.name, fmt::format("names buffer view {}, but there are {}", source.buffer_view,
                                           document.model.bufferViews.size()));
  const tinygltf::BufferView& view = document.model.bufferViews[index];
  const std::string where = at("bufferViews", index);
  if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= document.buffers.size())
    document.fail(where, fmt::format("names buffer {}, but there are {}", view.buffer, document.buffers.size()));
  const std::span<const uint8_t> buffer = document.buffers[static_cast<size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
    document.fail(where, "reaches beyond its buffer");
  return buffer.subspan(view.byteOffset, view.byteLength);
}

TextureWrap wrap_of(int code) {
  return code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? TextureWrap::clamp
         : code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror
                                                         : TextureWrap::repeat;
}

}  // namespace

double number_in(const tinygltf::Value& object, const char* key, double otherwise) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

std::vector<double> numbers_in(const tinygltf::Value& object, const char* key, const std::vector<double>& otherwise) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& list = object.Get(key);
  if (!list.IsArray() || list.ArrayLen() != otherwise.size()) return otherwise;
  std::vector<double> numbers;
  for (int i = 0; i < static_cast<int>(list.ArrayLen()); ++i) {
    if (!list.Get(i).IsNumber()) return otherwise;
    numbers.push_back(list.Get(i).GetNumberAsDouble());
  }
  return numbers;
}

/// The extension says that coordinates turn counter-clockwise; with v downwards, as glTF has it, that is this way
/// round. (The formula in its text turns the other way; viewers and exporters agree on this one.)
void TextureReader::place(int uv_set, const tinygltf::ExtensionMap& extensions, TextureRef& texture) {
  double wanted_set = uv_set;
  if (const auto found = extensions.find("KHR_texture_transform"); found != extensions.end()) {
    const tinygltf::Value& transform = found->second;
    const std::vector<double> offset = numbers_in(transform, "offset", {0, 0});
    const std::vector<double> scale = numbers_in(transform, "scale", {1, 1});
    const double rotation = std::clamp(number_in(transform, "rotation", 0), -kMostTurns, kMostTurns);
    wanted_set = number_in(transform, "texCoord", wanted_set);
    const double cosine = rotation == 0 ? 1 : std::cos(rotation), sine = rotation == 0 ? 0 : std::sin(rotation);
    texture.placement = {Vec3f{coefficient(cosine * scale[0]), coefficient(sine * scale[1]), coefficient(offset[0])},
                         Vec3f{coefficient(-sine * scale[0]), coefficient(cosine * scale[1]), coefficient(offset[1])}};
  }
  if (wanted_set >= 0 && wanted_set < kMostUvSets) {
    texture.uv_set = static_cast<uint32_t>(wanted_set);
  } else {
    warnings_.add(where_, fmt::format("textures that take other texture coordinates than sets 0 to {} are left out",
                                      kMostUvSets - 1));
    texture.picture.clear();
  }
}

TextureRef TextureReader::read(int index, int uv_set, const tinygltf::ExtensionMap& extensions) {
  if (index < 0) return {};
  const auto& textures = document_.model.textures;
  if (static_cast<size_t>(index) >= textures.size())
    document_.fail(where_, fmt::format("names texture {}, but there are {}", index, textures.size()));
  const tinygltf::Texture& texture = textures[static_cast<size_t>(index)];
  if (texture.source < 0) {
    warnings_.add(where_, "a texture without an image is left out");
    return {};
  }
  if (static_cast<size_t>(texture.source) >= document_.images.size())
    document_.fail(at("textures", static_cast<size_t>(index)),
                   fmt::format("names image {}, but there are {}", texture.source, document_.images.size()));
  const ImageSource& source = document_.images[static_cast<size_t>(texture.source)];
  if (source.name.empty()) warnings_.add(where_, "a texture whose image has no source is left out");
  if (source.embedded && !scene_.embedded_pictures.count(source.name)) {
    const std::span<const uint8_t> bytes = picture_bytes(document_, source);
    document_.charge(bytes.size(), where_);
    scene_.embedded_pictures.emplace(source.name, std::vector<uint8_t>(bytes.begin(), bytes.end()));
  }
  TextureRef result;
  result.picture = source.name;
  const auto& samplers = document_.model.samplers;
  if (texture.sampler >= 0 && static_cast<size_t>(texture.sampler) < samplers.size()) {
    const tinygltf::Sampler& sampler = samplers[static_cast<size_t>(texture.sampler)];
    result.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
  }
  place(uv_set, extensions, result);
  return result;
}

TextureRef TextureReader::read(const tinygltf::Value& extension, const char* key) {
  if (!extension.Has(key)) return {};
  const tinygltf::Value& object = extension.Get(key);
  constexpr double kMost = 1e9;
  tinygltf::ExtensionMap extensions;
  if (object.Has("extensions") && object.Get("extensions").Has("KHR_texture_transform"))
    extensions["KHR_texture_transform"] = object.Get("extensions").Get("KHR_texture_transform");
  return read(static_cast<int>(std::clamp(number_in(object, "index", -1), -1.0, kMost)),
              static_cast<int>(std::clamp(number_in(object, "texCoord", 0), 0.0, kMost)), extensions);
}

}  // namespace kairos::gltf
