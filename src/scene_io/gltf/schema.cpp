#include "scene_io/gltf/schema.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include <kairos/error.h>

#include "scene_io/gltf/text.h"

namespace kairos::gltf {

namespace {

using nlohmann::json;

enum class Kind { index, size, number, text, flag, object, indices, numbers, texts };

/// `path`: "a.b" a member, "a[]" every element of an array, "a{}" every member of an object.
struct Rule {
  const char* path;
  Kind kind;
};

// Each index becomes a 32-bit int and each size a 64-bit one.
constexpr Rule kRules[] = {
    {"asset.version", Kind::text},
    {"extensionsUsed", Kind::texts},
    {"extensionsRequired", Kind::texts},
    {"scene", Kind::index},
    {"scenes[].name", Kind::text},
    {"scenes[].nodes", Kind::indices},
    {"nodes[].name", Kind::text},
    {"nodes[].mesh", Kind::index},
    {"nodes[].skin", Kind::index},
    {"nodes[].camera", Kind::index},
    {"nodes[].children", Kind::indices},
    {"nodes[].matrix", Kind::numbers},
    {"nodes[].translation", Kind::numbers},
    {"nodes[].rotation", Kind::numbers},
    {"nodes[].scale", Kind::numbers},
    {"nodes[].weights", Kind::numbers},
    {"meshes[].name", Kind::text},
    {"meshes[].weights", Kind::numbers},
    {"meshes[].primitives[].attributes{}", Kind::index},
    {"meshes[].primitives[].indices", Kind::index},
    {"meshes[].primitives[].material", Kind::index},
    {"meshes[].primitives[].mode", Kind::index},
    {"meshes[].primitives[].targets[]{}", Kind::index},
    {"accessors[].bufferView", Kind::index},
    {"accessors[].byteOffset", Kind::size},
    {"accessors[].componentType", Kind::index},
    {"accessors[].normalized", Kind::flag},
    {"accessors[].count", Kind::size},
    {"accessors[].type", Kind::text},
    {"accessors[].sparse.count", Kind::index},
    {"accessors[].sparse.indices.bufferView", Kind::index},
    {"accessors[].sparse.indices.byteOffset", Kind::index},
    {"accessors[].sparse.indices.componentType", Kind::index},
    {"accessors[].sparse.values.bufferView", Kind::index},
    {"accessors[].sparse.values.byteOffset", Kind::index},
    {"bufferViews[].buffer", Kind::index},
    {"bufferViews[].byteOffset", Kind::size},
    {"bufferViews[].byteLength", Kind::size},
    {"bufferViews[].byteStride", Kind::index},
    {"buffers[].uri", Kind::text},
    {"buffers[].byteLength", Kind::size},
    {"images[].uri", Kind::text},
    {"images[].bufferView", Kind::index},
    {"textures[].source", Kind::index},
    {"materials[].name", Kind::text},
    {"materials[].pbrMetallicRoughness.baseColorFactor", Kind::numbers},
    {"materials[].pbrMetallicRoughness.metallicFactor", Kind::number},
    {"materials[].pbrMetallicRoughness.roughnessFactor", Kind::number},
    {"materials[].pbrMetallicRoughness.baseColorTexture.index", Kind::index},
    {"materials[].pbrMetallicRoughness.baseColorTexture.texCoord", Kind::index},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture.index", Kind::index},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture.texCoord", Kind::index},
    {"materials[].emissiveTexture.index", Kind::index},
    {"materials[].emissiveTexture.texCoord", Kind::index},
    {"materials[].emissiveFactor", Kind::numbers},
    {"materials[].alphaMode", Kind::text},
    {"materials[].alphaCutoff", Kind::number},
    {"materials[].doubleSided", Kind::flag},
    {"materials[].extensions{}", Kind::object},
    {"animations[].name", Kind::text},
    {"animations[].channels[].sampler", Kind::index},
    {"animations[].channels[].target.node", Kind::index},
    {"animations[].channels[].target.path", Kind::text},
    {"animations[].samplers[].input", Kind::index},
    {"animations[].samplers[].output", Kind::index},
    {"animations[].samplers[].interpolation", Kind::text},
    {"skins[].joints", Kind::indices},
    {"skins[].inverseBindMatrices", Kind::index},
    {"cameras[].name", Kind::text},
    {"cameras[].type", Kind::text},
    {"cameras[].perspective.yfov", Kind::number},
    {"cameras[].perspective.znear", Kind::number},
    {"cameras[].orthographic.xmag", Kind::number},
    {"cameras[].orthographic.ymag", Kind::number},
};

constexpr uint64_t kLargestIndex = std::numeric_limits<int32_t>::max();
constexpr uint64_t kLargestSize = uint64_t{1} << 53;  // what a JSON number surely holds

[[noreturn]] void expected(const char* what, const std::string& place) {
  throw Error(ErrorCode::bad_input, place, std::string("must be ") + what);
}

void check_integer(json& value, uint64_t largest, const std::string& place) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number >= 0 && number <= static_cast<double>(largest) && number == std::floor(number))
      value = static_cast<uint64_t>(number);
  }
  if (!value.is_number_unsigned()) expected("a whole number that is not negative", place);
  if (value.get<uint64_t>() > largest)
    throw Error(ErrorCode::bad_input, place, "is larger than " + std::to_string(largest));
}

void check_kind(json& value, Kind kind, const std::string& place) {
  const auto each = [&](Kind element_kind) {
    if (!value.is_array()) expected("an array", place);
    for (size_t i = 0; i < value.size(); ++i) check_kind(value[i], element_kind, place + "[" + std::to_string(i) + "]");
  };
  switch (kind) {
    case Kind::index:
      return check_integer(value, kLargestIndex, place);
    case Kind::size:
      return check_integer(value, kLargestSize, place);
    case Kind::indices:
      return each(Kind::index);
    case Kind::numbers:
      return each(Kind::number);
    case Kind::texts:
      return each(Kind::text);
    case Kind::number:
      if (!value.is_number()) expected("a number", place);
      return;
    case Kind::text:
      if (!value.is_string()) expected("a string", place);
      return;
    case Kind::flag:
      if (!value.is_boolean()) expected("true or false", place);
      return;
    case Kind::object:
      if (!value.is_object()) expected("an object", place);
      return;
  }
}

/// Recursion is as deep as the longest path in the table.
void check(json& value, std::string_view path, Kind kind, const std::string& place) {
  if (path.empty()) return check_kind(value, kind, place);
  if (path.substr(0, 2) == "[]") {
    if (!value.is_array()) expected("an array", place);
    for (size_t i = 0; i < value.size(); ++i)
      check(value[i], path.substr(2), kind, place + "[" + std::to_string(i) + "]");
    return;
  }
  if (!value.is_object()) expected("an object", place);
  if (path.substr(0, 2) == "{}") {
    for (auto member = value.begin(); member != value.end(); ++member)
      check(member.value(), path.substr(2), kind, place + "." + printable(member.key()));
    return;
  }
  if (path.front() == '.') path.remove_prefix(1);
  const size_t end = path.find_first_of(".[{");
  const std::string key(path.substr(0, end));
  const auto member = value.find(key);
  if (member == value.end()) return;
  const char* separator = place.substr(place.size() - 2) == ": " ? "" : ".";
  check(member.value(), end == std::string_view::npos ? "" : path.substr(end), kind, place + separator + key);
}

}  // namespace

void check_schema(json& document, const std::string& name) {
  if (!document.is_object()) throw Error(ErrorCode::bad_input, name, "is not a JSON object");
  for (const Rule& rule : kRules) check(document, rule.path, rule.kind, name + ": ");
}

}  // namespace kairos::gltf
