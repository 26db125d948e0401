#include "scene_io/gltf_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace kairos::gltf {

namespace {

/// A factor within [lowest, highest]; NaN cannot come out of JSON.
float factor(double value, double lowest, double highest) {
  return static_cast<float>(std::clamp(value, lowest, highest));
}

constexpr double kQuarterTurn = 1.5707964;  // as a float has it, rounded up
constexpr double kLargest = 1e30;  // of what has no upper limit: far above any light, far below float's overflow

/// Number `key` of extension `name`, or `otherwise`.
double extension_number(const tinygltf::ExtensionMap& extensions, const char* name, const char* key, double otherwise) {
  const auto found = extensions.find(name);
  if (found == extensions.end() || !found->second.Has(key)) return otherwise;
  const tinygltf::Value& value = found->second.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
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

/// The path or name of a texture's picture, whose bytes join the scene if they are inside the file; empty for none.
template <class Info>
std::string texture_name(Document& document, const Info& info, const std::string& where, Scene& scene,
                         Warnings& warnings) {
  if (info.index < 0) return "";
  const auto& textures = document.model.textures;
  if (static_cast<size_t>(info.index) >= textures.size())
    document.fail(where, fmt::format("names texture {}, but there are {}", info.index, textures.size()));
  const int image = textures[static_cast<size_t>(info.index)].source;
  if (image < 0) {
    warnings.add(where, "a texture without an image is left out");
    return "";
  }
  if (static_cast<size_t>(image) >= document.images.size())
    document.fail(at("textures", static_cast<size_t>(info.index)),
                  fmt::format("names image {}, but there are {}", image, document.images.size()));
  const ImageSource& source = document.images[static_cast<size_t>(image)];
  if (source.name.empty()) warnings.add(where, "a texture whose image has no source is left out");
  if (source.embedded && !scene.embedded_pictures.count(source.name)) {
    const std::span<const uint8_t> bytes = picture_bytes(document, source);
    document.charge(bytes.size(), where);
    scene.embedded_pictures.emplace(source.name, std::vector<uint8_t>(bytes.begin(), bytes.end()));
  }
  if (info.texCoord != 0)
    warnings.add(where, "a texture that uses other coordinates than TEXCOORD_0 will be misplaced");
  return source.name;
}

Vec3f color(const std::vector<double>& values, double scale, double highest) {
  return {factor(values[0] * scale, 0, highest), factor(values[1] * scale, 0, highest),
          factor(values[2] * scale, 0, highest)};
}

Material read_material(Document& document, const tinygltf::Material& source, const std::string& where, Scene& scene,
                       Warnings& warnings) {
  const auto& pbr = source.pbrMetallicRoughness;
  Material material;
  material.name = printable(source.name);
  if (pbr.baseColorFactor.size() != 4) document.fail(where, "its baseColorFactor must have 4 numbers");
  material.base_color = color(pbr.baseColorFactor, 1, 1);
  material.alpha = factor(pbr.baseColorFactor[3], 0, 1);
  material.metallic = factor(pbr.metallicFactor, 0, 1);
  material.roughness = factor(pbr.roughnessFactor, 0, 1);
  const double strength = extension_number(source.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1);
  if (source.emissiveFactor.size() == 3) material.emission = color(source.emissiveFactor, strength, kLargest);
  material.ior = factor(extension_number(source.extensions, "KHR_materials_ior", "ior", 1.5), 0, kLargest);
  material.transmission =
      factor(extension_number(source.extensions, "KHR_materials_transmission", "transmissionFactor", 0), 0, 1);
  material.thin_walled = !(extension_number(source.extensions, "KHR_materials_volume", "thicknessFactor", 0) > 0);
  if (source.alphaMode == "MASK")
    material.alpha_mode = Material::AlphaMode::mask;
  else if (source.alphaMode == "BLEND")
    material.alpha_mode = Material::AlphaMode::blend;
  else if (source.alphaMode != "OPAQUE" && !source.alphaMode.empty())
    document.fail(where, "has the unknown alphaMode '" + printable(source.alphaMode) + "'");
  material.alpha_cutoff = factor(source.alphaCutoff, 0, kLargest);
  material.double_sided = source.doubleSided;
  const auto texture = [&](const auto& info) { return texture_name(document, info, where, scene, warnings); };
  material.base_color_texture = texture(pbr.baseColorTexture);
  material.emission_texture = texture(source.emissiveTexture);
  material.metallic_roughness_texture = texture(pbr.metallicRoughnessTexture);
  return material;
}

}  // namespace

void read_materials(Document& document, Scene& scene, Warnings& warnings) {
  const auto& sources = document.model.materials;
  for (size_t i = 0; i < sources.size(); ++i)
    scene.materials.push_back(read_material(document, sources[i], at("materials", i), scene, warnings));
  tinygltf::Material otherwise;
  otherwise.name = "default";
  scene.materials.push_back(read_material(document, otherwise, "materials", scene, warnings));
}

SceneCamera read_camera(const Document& document, size_t index) {
  constexpr double kPi = 3.14159265358979323846;
  const tinygltf::Camera& source = document.model.cameras[index];
  const std::string where = at("cameras", index);
  SceneCamera camera;
  if (source.type == "perspective") {
    camera.vfov = source.perspective.yfov;
    if (!(camera.vfov > 0 && camera.vfov < kPi)) document.fail(where, "its yfov must lie between 0 and pi");
  } else if (source.type == "orthographic") {
    camera.orthographic = true;
    camera.view_height = 2 * std::abs(source.orthographic.ymag);
    if (!(camera.view_height > 0 && camera.view_height < kLargest)) document.fail(where, "its ymag must not be zero");
  } else {
    document.fail(where, "has the unknown type '" + printable(source.type) + "'");
  }
  return camera;
}

std::vector<Light> read_lights(const Document& document, const std::vector<int>& nodes, const std::vector<Mat4>& world,
                               Warnings& warnings) {
  std::vector<Light> result;
  const auto& lights = document.model.lights;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const auto& extensions = document.model.nodes[static_cast<size_t>(nodes[i])].extensions;
    const double number = extension_number(extensions, "KHR_lights_punctual", "light", -1);
    if (number == -1) continue;
    const std::string where = at("nodes", static_cast<size_t>(nodes[i]));
    if (!(number >= 0 && number < static_cast<double>(lights.size())))
      document.fail(where, fmt::format("names a light that does not exist: there are {}", lights.size()));
    const tinygltf::Light& light = lights[static_cast<size_t>(number)];
    if (!light.color.empty() && light.color.size() != 3) document.fail(where, "its light's color must have 3 numbers");
    const std::vector<double> white{1, 1, 1};
    const Vec3f radiometric = color(light.color.empty() ? white : light.color, light.intensity, kLargest);
    const Mat4& m = world[i];
    if (light.type == "point") {
      result.push_back(PointLight{to_float({m.m[3][0], m.m[3][1], m.m[3][2]}), radiometric});
    } else if (light.type == "directional") {
      result.push_back(DirectionalLight{to_float(normalize(transform_vector(m, {0, 0, -1}))), radiometric});
    } else if (light.type == "spot") {
      const double inner = light.spot.innerConeAngle, outer = light.spot.outerConeAngle;
      if (!(inner >= 0 && inner <= outer && outer <= kQuarterTurn))
        document.fail(where, "its light's cone angles make no sense");
      result.push_back(SpotLight{to_float({m.m[3][0], m.m[3][1], m.m[3][2]}),
                                 to_float(normalize(transform_vector(m, {0, 0, -1}))), radiometric,
                                 static_cast<float>(std::cos(inner)), static_cast<float>(std::cos(outer))});
    } else {
      warnings.add(where, "a light of type '" + printable(light.type) + "' is left out");
    }
  }
  return result;
}

}  // namespace kairos::gltf
