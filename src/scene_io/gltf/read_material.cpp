// Materials of a glTF file as it says them, and what is lost of those that say more than Kairos shows.
#include "scene_io/gltf/members.h"
#include "scene_io/gltf/read_model.h"

namespace kairos::gltf::file {

namespace {

TextureInfo read_texture_info(Members& info) {
  TextureInfo result;
  info.need("index");
  result.index = info.index("index");
  result.texCoord = info.index("texCoord", 0);
  info.extension("KHR_texture_transform", [&](Members& m) {
    result.transform.emplace();
    result.transform->offset = m.as_many_numbers("offset", {0, 0});
    result.transform->scale = m.as_many_numbers("scale", {1, 1});
    result.transform->rotation = m.number("rotation", 0);
    result.texCoord = m.index("texCoord", result.texCoord);
  });
  return result;
}

TextureInfo read_texture_info(Members& owner, const char* key) {
  TextureInfo result;
  owner.object(key, [&](Members& info) {
    const double scale = info.number("scale", 1);
    result = read_texture_info(info);
    result.scale = scale;
  });
  return result;
}

/// A layer whose strength, if it is 0 as it is unless said otherwise, makes all of it mean nothing.
void lose_layer(Members& m, const char* strength, const char* extension, const std::string& loss, Warnings& warnings) {
  m.extension(extension, [&](Members& layer) {
    bool is_there = false;
    const std::string place = layer.place();
    for (const double part : layer.numbers_or_number(strength)) is_there = is_there || part != 0;
    layer.pass_rest();
    if (is_there) warnings.add(place, loss);
  });
}

void read_layers(Members& m, Material& material, Warnings& warnings) {
  m.extension("KHR_materials_emissive_strength",
              [&](Members& e) { material.emissiveStrength = e.number("emissiveStrength", 1); });
  m.extension("KHR_materials_ior", [&](Members& e) { material.ior = e.number("ior", 1.5); });
  m.extension("KHR_materials_unlit", [&](Members&) { material.unlit = true; });
  m.extension("KHR_materials_transmission", [&](Members& e) {
    material.transmissionFactor = e.number("transmissionFactor", 0);
    e.lose("transmissionTexture", "a picture of transmission is left out: the surface lets light through evenly");
  });
  m.extension("KHR_materials_volume", [&](Members& e) {
    material.thicknessFactor = e.number("thicknessFactor", 0);
    e.pass("thicknessTexture");  // rays find how thick it is
    const bool is_coloured = e.has("attenuationDistance") && material.thicknessFactor > 0;
    e.pass("attenuationDistance");
    e.pass("attenuationColor");
    if (is_coloured)
      warnings.add(e.place(), "the colour of what is inside of glass is left out: it is as clear as air");
  });
  m.extension("KHR_materials_specular", [&](Members& e) {
    material.specularFactor = e.number("specularFactor", 1);
    material.specularColorFactor = e.as_many_numbers("specularColorFactor", {1, 1, 1});
    for (const char* picture : {"specularTexture", "specularColorTexture"})
      e.lose(picture, "pictures of specular strength and colour are left out: the surface reflects evenly");
  });
  m.extension("KHR_materials_clearcoat", [&](Members& e) {
    material.clearcoatFactor = e.number("clearcoatFactor", 0);
    material.clearcoatRoughnessFactor = e.number("clearcoatRoughnessFactor", 0);
    for (const char* picture : {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"})
      e.lose(picture, "pictures of a clear coat are left out: it is even");
  });
  lose_layer(m, "sheenColorFactor", "KHR_materials_sheen", "sheen is left out: cloth looks less velvety", warnings);
  lose_layer(m, "iridescenceFactor", "KHR_materials_iridescence",
             "iridescence is left out: the surface has no colours of thin films", warnings);
  lose_layer(m, "anisotropyStrength", "KHR_materials_anisotropy", "anisotropy is left out: highlights are round",
             warnings);
  lose_layer(m, "dispersion", "KHR_materials_dispersion", "dispersion is left out: glass makes no rainbows", warnings);
  lose_layer(m, "diffuseTransmissionFactor", "KHR_materials_diffuse_transmission",
             "diffuse transmission is left out: light does not shine through leaves and paper", warnings);
  m.extension("KHR_materials_pbrSpecularGlossiness", [&](Members& e) {
    SpecularGlossiness& glossy = material.glossy.emplace();
    glossy.diffuseFactor = e.as_many_numbers("diffuseFactor", {1, 1, 1, 1});
    glossy.glossinessFactor = e.number("glossinessFactor", 1);
    glossy.diffuseTexture = read_texture_info(e, "diffuseTexture");
    glossy.has_texture = e.has("specularGlossinessTexture");
    e.lose("specularGlossinessTexture", "a specularGlossinessTexture is left out: the surface is matt");
    e.pass("specularFactor");  // the colour of what is mirrored: the metal-and-roughness model has none of its own
  });
}

}  // namespace

Material read_material(Members& m, Warnings& warnings) {
  Material material;
  material.name = m.text("name");
  m.object("pbrMetallicRoughness", [&](Members& pbr) {
    material.baseColorFactor = pbr.as_many_numbers("baseColorFactor", {1, 1, 1, 1});
    material.metallicFactor = pbr.number("metallicFactor", 1);
    material.roughnessFactor = pbr.number("roughnessFactor", 1);
    material.baseColorTexture = read_texture_info(pbr, "baseColorTexture");
    material.metallicRoughnessTexture = read_texture_info(pbr, "metallicRoughnessTexture");
  });
  material.normalTexture = read_texture_info(m, "normalTexture");
  material.emissiveTexture = read_texture_info(m, "emissiveTexture");
  material.emissiveFactor = m.as_many_numbers("emissiveFactor", {0, 0, 0});
  material.alphaMode = m.text("alphaMode", "OPAQUE");
  material.alphaCutoff = m.number("alphaCutoff", 0.5);
  material.doubleSided = m.flag("doubleSided");
  m.lose("occlusionTexture",
         "pictures of occlusion are left out: what shades a surface is what rays find in the way of light");
  read_layers(m, material, warnings);
  return material;
}

}  // namespace kairos::gltf::file
