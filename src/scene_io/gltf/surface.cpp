#include "scene_io/gltf/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include <kairos/printable.h>

#include "scene_io/gltf/texture.h"

namespace kairos::gltf {

namespace {

/// A factor within [lowest, highest]; NaN cannot come out of JSON.
float factor(double value, double lowest, double highest) {
  return static_cast<float>(std::clamp(value, lowest, highest));
}

constexpr double kQuarterTurn = 1.5707964;  // as a float has it, rounded up
constexpr double kLargest = 1e30;  // of what has no upper limit: far above any light, far below float's overflow

Vec3f color(const std::vector<double>& values, double scale, double highest) {
  return {factor(values[0] * scale, 0, highest), factor(values[1] * scale, 0, highest),
          factor(values[2] * scale, 0, highest)};
}

Material material_of(Document& document, const file::Material& source, const std::string& where, Scene& scene,
                     Warnings& warnings) {
  const auto texture = [&](const file::TextureInfo& info) {
    return read_texture(document, info, where, scene, warnings);
  };
  Material material;
  material.name = printable(source.name);
  material.base_color = color(source.baseColorFactor, 1, 1);
  material.alpha = factor(source.baseColorFactor[3], 0, 1);
  material.metallic = factor(source.metallicFactor, 0, 1);
  material.roughness = factor(source.roughnessFactor, 0, 1);
  material.emission = color(source.emissiveFactor, source.emissiveStrength, kLargest);
  material.ior = factor(source.ior, 0, kLargest);
  material.specular = factor(source.specularFactor, 0, 1);
  material.specular_color = color(source.specularColorFactor, 1, kLargest);
  material.clearcoat = factor(source.clearcoatFactor, 0, 1);
  material.clearcoat_roughness = factor(source.clearcoatRoughnessFactor, 0, 1);
  material.transmission = factor(source.transmissionFactor, 0, 1);
  material.thin_walled = !(source.thicknessFactor > 0);
  if (source.alphaMode == "MASK")
    material.alpha_mode = Material::AlphaMode::mask;
  else if (source.alphaMode == "BLEND")
    material.alpha_mode = Material::AlphaMode::blend;
  else if (source.alphaMode != "OPAQUE")
    document.fail(where, "has the unknown alphaMode '" + printable(source.alphaMode) + "'");
  material.alpha_cutoff = factor(source.alphaCutoff, 0, kLargest);
  material.double_sided = source.doubleSided;
  if (source.glossy) {
    // The older model of surfaces, as far as ours goes: its diffuse colour, which most of its users see most of.
    material.base_color = color(source.glossy->diffuseFactor, 1, 1);
    material.alpha = factor(source.glossy->diffuseFactor[3], 0, 1);
    material.metallic = 0;
    material.roughness = source.glossy->has_texture ? 1 : 1 - factor(source.glossy->glossinessFactor, 0, 1);
    material.base_color_texture = texture(source.glossy->diffuseTexture);
  } else {
    material.base_color_texture = texture(source.baseColorTexture);
    material.metallic_roughness_texture = texture(source.metallicRoughnessTexture);
  }
  material.emission_texture = texture(source.emissiveTexture);
  material.normal_texture = texture(source.normalTexture);
  material.normal_scale = factor(source.normalTexture.scale, -kLargest, kLargest);
  if (source.unlit) {
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
    scene.materials.push_back(material_of(document, sources[i], at("materials", i), scene, warnings));
  file::Material otherwise;
  otherwise.name = "default";
  scene.materials.push_back(material_of(document, otherwise, "materials", scene, warnings));
}

SceneCamera read_camera(const Document& document, size_t index) {
  const file::Camera& source = document.model.cameras[index];
  const std::string where = at("cameras", index);
  SceneCamera camera;
  if (source.type == "perspective") {
    camera.vfov = source.yfov;
    if (!(camera.vfov > 0 && camera.vfov < std::numbers::pi))
      document.fail(where, "its yfov must lie between 0 and pi");
  } else if (source.type == "orthographic") {
    camera.orthographic = true;
    camera.view_height = 2 * std::abs(source.ymag);
    if (!(camera.view_height > 0 && camera.view_height < kLargest)) document.fail(where, "its ymag must not be zero");
  } else {
    document.fail(where, "has the unknown type '" + printable(source.type) + "'");
  }
  return camera;
}

std::optional<Light> read_light(const Document& document, int node, Warnings& warnings) {
  const int number = document.model.nodes[static_cast<size_t>(node)].light;
  if (number == -1) return std::nullopt;
  const std::string where = at("nodes", static_cast<size_t>(node));
  const auto& lights = document.model.lights;
  if (static_cast<size_t>(number) >= lights.size())
    document.fail(where, fmt::format("names a light that does not exist: there are {}", lights.size()));
  const file::Light& light = lights[static_cast<size_t>(number)];
  const Vec3f radiometric = color(light.color, light.intensity, kLargest);
  constexpr Vec3f kAlong{0, 0, -1};
  if (light.type == "point") return PointLight{{}, radiometric};
  if (light.type == "directional") return DirectionalLight{kAlong, radiometric};
  if (light.type == "spot") {
    const double inner = light.innerConeAngle, outer = light.outerConeAngle;
    if (!(inner >= 0 && inner <= outer && outer <= kQuarterTurn))
      document.fail(where, "its light's cone angles make no sense");
    return SpotLight{{}, kAlong, radiometric, static_cast<float>(std::cos(inner)), static_cast<float>(std::cos(outer))};
  }
  warnings.add(where, "a light of type '" + printable(light.type) + "' is left out");
  return std::nullopt;
}

}  // namespace kairos::gltf
