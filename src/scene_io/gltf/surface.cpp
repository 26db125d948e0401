#include "scene_io/gltf/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "scene_io/gltf/texture.h"

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
  return found == extensions.end() ? otherwise : number_in(found->second, key, otherwise);
}

Vec3f color(const std::vector<double>& values, double scale, double highest) {
  return {factor(values[0] * scale, 0, highest), factor(values[1] * scale, 0, highest),
          factor(values[2] * scale, 0, highest)};
}

/// The older model of surfaces, as far as ours goes: its diffuse colour, which most of its users see most of. What it
/// mirrors in colour is left out.
void read_specular_glossiness(const tinygltf::Value& glossy, const std::string& where, TextureReader& textures,
                              Material& material, Warnings& warnings) {
  const std::vector<double> diffuse = numbers_in(glossy, "diffuseFactor", {1, 1, 1, 1});
  material.base_color = color(diffuse, 1, 1);
  material.alpha = factor(diffuse[3], 0, 1);
  material.metallic = 0;
  material.roughness = 1 - factor(number_in(glossy, "glossinessFactor", 1), 0, 1);
  material.base_color_texture = textures.read(glossy, "diffuseTexture");
  if (glossy.Has("specularGlossinessTexture")) {
    material.roughness = 1;  // anything: it is in the picture
    warnings.add(where, "a specularGlossinessTexture is left out: the surface is matt");
  }
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
  TextureReader textures(document, where, scene, warnings);
  const auto glossy = source.extensions.find("KHR_materials_pbrSpecularGlossiness");
  if (glossy != source.extensions.end()) {
    read_specular_glossiness(glossy->second, where, textures, material, warnings);
  } else {
    material.base_color_texture = textures.read(pbr.baseColorTexture);
    material.metallic_roughness_texture = textures.read(pbr.metallicRoughnessTexture);
  }
  material.emission_texture = textures.read(source.emissiveTexture);
  material.normal_texture = textures.read(source.normalTexture);
  material.normal_scale = factor(source.normalTexture.scale, -kLargest, kLargest);
  if (source.extensions.count("KHR_materials_unlit") != 0) {
    material.unlit = true;
    material.emission = {};
    material.emission_texture = {};
    material.metallic = 0;
    material.roughness = 1;
    material.metallic_roughness_texture = {};
    material.normal_texture = {};
  }
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
