#include "scene_io/gltf/texture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kairos::gltf {

namespace {

constexpr double kMostTurns = 1e6;  // radians; beyond, a float's sine is noise

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
Vec2f TexturePlace::apply(Vec2f uv) const {
  if (offset == Vec2d{0, 0} && scale == Vec2d{1, 1} && rotation == 0) return uv;
  const double u = static_cast<double>(uv.x) * scale.x, v = static_cast<double>(uv.y) * scale.y;
  const double cosine = std::cos(rotation), sine = std::sin(rotation);
  const Vec2f placed{static_cast<float>(cosine * u + sine * v + offset.x),
                     static_cast<float>(-sine * u + cosine * v + offset.y)};
  return std::isfinite(placed.x) && std::isfinite(placed.y) ? placed : Vec2f{};
}

TexturePlace TextureReader::place_of(const tinygltf::TextureInfo& info, const tinygltf::Texture& texture) {
  TexturePlace place;
  place.set = info.texCoord;
  if (const auto found = info.extensions.find("KHR_texture_transform"); found != info.extensions.end()) {
    const tinygltf::Value& transform = found->second;
    const std::vector<double> offset = numbers_in(transform, "offset", {0, 0});
    const std::vector<double> scale = numbers_in(transform, "scale", {1, 1});
    place.offset = {offset[0], offset[1]};
    place.scale = {scale[0], scale[1]};
    place.rotation = std::clamp(number_in(transform, "rotation", 0), -kMostTurns, kMostTurns);
    constexpr double kMostSets = 1000;
    place.set = static_cast<int>(std::clamp(number_in(transform, "texCoord", place.set), 0.0, kMostSets));
  }
  const auto& samplers = document_.model.samplers;
  if (texture.sampler >= 0 && static_cast<size_t>(texture.sampler) < samplers.size()) {
    const tinygltf::Sampler& sampler = samplers[static_cast<size_t>(texture.sampler)];
    place.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
  }
  return place;
}

std::string TextureReader::read(const tinygltf::TextureInfo& info) {
  if (info.index < 0) return "";
  const auto& textures = document_.model.textures;
  if (static_cast<size_t>(info.index) >= textures.size())
    document_.fail(where_, fmt::format("names texture {}, but there are {}", info.index, textures.size()));
  const tinygltf::Texture& texture = textures[static_cast<size_t>(info.index)];
  if (texture.source < 0) {
    warnings_.add(where_, "a texture without an image is left out");
    return "";
  }
  if (static_cast<size_t>(texture.source) >= document_.images.size())
    document_.fail(at("textures", static_cast<size_t>(info.index)),
                   fmt::format("names image {}, but there are {}", texture.source, document_.images.size()));
  const ImageSource& source = document_.images[static_cast<size_t>(texture.source)];
  if (source.name.empty()) warnings_.add(where_, "a texture whose image has no source is left out");
  if (source.embedded && !scene_.embedded_pictures.count(source.name)) {
    const std::span<const uint8_t> bytes = picture_bytes(document_, source);
    document_.charge(bytes.size(), where_);
    scene_.embedded_pictures.emplace(source.name, std::vector<uint8_t>(bytes.begin(), bytes.end()));
  }
  const TexturePlace place = place_of(info, texture);
  if (!place_) place_ = place;
  if (place != *place_)
    warnings_.add(where_, "a texture that lies otherwise than its material's first one will be misplaced");
  return source.name;
}

std::string TextureReader::read(const tinygltf::Value& extension, const char* key) {
  if (!extension.Has(key)) return "";
  const tinygltf::Value& object = extension.Get(key);
  constexpr double kMost = 1e9;
  tinygltf::TextureInfo info;
  info.index = static_cast<int>(std::clamp(number_in(object, "index", -1), -1.0, kMost));
  info.texCoord = static_cast<int>(std::clamp(number_in(object, "texCoord", 0), 0.0, kMost));
  if (object.Has("extensions") && object.Get("extensions").Has("KHR_texture_transform"))
    info.extensions["KHR_texture_transform"] = object.Get("extensions").Get("KHR_texture_transform");
  return read(info);
}

}  // namespace kairos::gltf
