// Small glTF documents made in memory, for tests: a JSON tree to fill in and one buffer that accessors append to.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene_io/gltf/gltf.h"

namespace kairos {

class GltfBuilder {
 public:
  nlohmann::json root = {{"asset", {{"version", "2.0"}}}};
  std::vector<uint8_t> bytes;

  /// Index of a new buffer view with these numbers.
  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    while (bytes.size() % 4) bytes.push_back(0);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride) view["byteStride"] = stride;
    const size_t begin = bytes.size();
    bytes.resize(begin + values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes.data() + begin, values.data(), values.size() * sizeof(T));
    return push("bufferViews", std::move(view));
  }

  /// Index of a new accessor of tightly packed numbers; type "SCALAR", "VEC3", ...
  template <class T>
  int accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
    const size_t components = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    nlohmann::json accessor = {{"bufferView", view(values)},
                               {"componentType", component_type(T{})},
                               {"count", values.size() / components},
                               {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return push("accessors", std::move(accessor));
  }

  /// Appends to a top-level array; the index there.
  int push(const char* array, nlohmann::json value) {
    root[array].push_back(std::move(value));
    return static_cast<int>(root[array].size()) - 1;
  }

  /// A mesh with one primitive of these attributes; gives node 0 when it is the first thing made.
  int mesh_node(nlohmann::json primitive, nlohmann::json node = nlohmann::json::object()) {
    node["mesh"] = push("meshes", {{"primitives", {std::move(primitive)}}});
    return push("nodes", std::move(node));
  }

  /// A node that shows one triangle with these corners.
  int triangle_node(const std::vector<float>& corners = {0, 0, 0, 1, 0, 0, 0, 1, 0},
                    nlohmann::json node = nlohmann::json::object()) {
    return mesh_node({{"attributes", {{"POSITION", accessor(corners, "VEC3")}}}}, std::move(node));
  }

  /// Animates `path` of `node` in animation 0.
  void animate(int node, const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
               const std::string& type, const std::string& interpolation = "LINEAR") {
    nlohmann::json& animation = root["animations"][0];
    animation["samplers"].push_back(
        {{"input", accessor(times, "SCALAR")}, {"output", accessor(values, type)}, {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  std::string text() const {
    nlohmann::json full = root;
    if (!bytes.empty() && !full.contains("buffers"))
      full["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64()}}};
    return full.dump();
  }

  std::vector<uint8_t> glb() const {
    nlohmann::json full = root;
    full["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string json = full.dump();
    while (json.size() % 4) json.push_back(' ');
    std::vector<uint8_t> binary = bytes;
    while (binary.size() % 4) binary.push_back(0);
    std::vector<uint8_t> file = {'g', 'l', 'T', 'F'};
    const auto word = [&](size_t value) {
      for (int shift = 0; shift < 32; shift += 8) file.push_back(static_cast<uint8_t>(value >> shift));
    };
    word(2);
    word(12 + 8 + json.size() + 8 + binary.size());
    word(json.size());
    word(0x4E4F534A);
    file.insert(file.end(), json.begin(), json.end());
    word(binary.size());
    word(0x004E4942);
    file.insert(file.end(), binary.begin(), binary.end());
    return file;
  }

  Scene parse(const LoadOptions& options = {}) const { return parse_text(text(), options); }

  static Scene parse_text(const std::string& text, const LoadOptions& options = {}, const std::string& folder = "") {
    return parse_gltf({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "test.gltf", folder, options);
  }

 private:
  static int component_type(int8_t) { return 5120; }
  static int component_type(uint8_t) { return 5121; }
  static int component_type(int16_t) { return 5122; }
  static int component_type(uint16_t) { return 5123; }
  static int component_type(uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }

  std::string base64() const {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    for (size_t i = 0; i < bytes.size(); i += 3) {
      uint32_t bits = 0;
      for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
      for (size_t k = 0; k < 4; ++k)
        result.push_back(i + k <= bytes.size() ? digits[(bits >> (18 - 6 * k)) & 63] : '=');
    }
    return result;
  }
};

/// Positions of the scene's mesh number `mesh`.
inline std::vector<Vec3d> positions_at(const Scene& scene, double time, Side side = Side::after, size_t mesh = 0) {
  std::vector<Vec3d> result(scene.meshes.at(mesh).motion->vertex_count());
  scene.meshes[mesh].motion->positions(time, side, result);
  return result;
}

inline std::vector<Vec3f> normals_at(const Scene& scene, double time, Side side = Side::after, size_t mesh = 0) {
  std::vector<Vec3f> result(scene.meshes.at(mesh).motion->vertex_count());
  scene.meshes[mesh].motion->normals(time, side, result);
  return result;
}

}  // namespace kairos
