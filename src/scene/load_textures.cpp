#include "scene/load_textures.h"

#include <map>
#include <new>
#include <utility>

#include <kairos/error.h>

#include "base/parallel.h"
#include "image/texture.h"

namespace kairos {

namespace {

struct Slot {
  std::shared_ptr<const Texture> texture;
  std::string failure;  // why there is none
  ErrorCode code = ErrorCode::bad_input;
};

using Key = std::pair<std::string, Texture::Encoding>;

Pixels pixels_of(const Scene& scene, const std::string& name) {
  const auto picture = scene.pictures.find(name);
  if (picture != scene.pictures.end()) return picture->second;
  const auto embedded = scene.embedded_pictures.find(name);
  return embedded == scene.embedded_pictures.end() ? read_picture(name) : decode_picture(embedded->second, name);
}

Slot read(const Scene& scene, const Key& key) {
  Slot slot;
  const auto& [name, encoding] = key;
  try {
    slot.texture = std::make_shared<const Texture>(pixels_of(scene, name), encoding);
  } catch (const Error& e) {
    slot.failure = e.what();
    slot.code = e.code();
  } catch (const std::bad_alloc&) {
    slot.failure = name + ": needs more memory than there is";
  }
  return slot;
}

}  // namespace

std::vector<MaterialTextures> load_textures(const Scene& scene, bool cut_outs_only, bool strict,
                                            std::vector<std::string>& notes) {
  std::map<Key, Slot> slots;
  const auto ask = [&](const TextureRef& texture, Texture::Encoding encoding) {
    if (!texture.empty()) slots.try_emplace({texture.picture, encoding});
  };
  std::vector<bool> is_used(scene.materials.size(), false);
  for (const SceneMesh& mesh : scene.meshes)
    if (mesh.material < is_used.size()) is_used[mesh.material] = true;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    if (!is_used[i]) continue;
    if (!cut_outs_only || material.alpha_mode != Material::AlphaMode::opaque) {
      ask(material.base_color_texture, Texture::Encoding::srgb);
      ask(material.alpha_texture, Texture::Encoding::linear);
    }
    if (cut_outs_only) continue;
    ask(material.emission_texture, Texture::Encoding::srgb);
    ask(material.metallic_roughness_texture, Texture::Encoding::linear);
    ask(material.normal_texture, Texture::Encoding::linear);
  }
  if (slots.empty()) return {};

  std::vector<std::pair<const Key, Slot>*> all;
  for (auto& slot : slots) all.push_back(&slot);
  parallel_for(all.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) all[i]->second = read(scene, all[i]->first);
  });
  for (const auto& [key, slot] : slots) {
    if (slot.texture) continue;
    if (strict) throw Error(slot.code, "", slot.failure);
    notes.push_back("texture left out: " + slot.failure);
  }

  std::vector<MaterialTextures> result;
  const auto find = [&](const TextureRef& texture, Texture::Encoding encoding) {
    const auto slot = slots.find({texture.picture, encoding});
    return slot == slots.end() ? nullptr : slot->second.texture;
  };
  for (const Material& material : scene.materials)
    result.push_back({find(material.base_color_texture, Texture::Encoding::srgb),
                      find(material.emission_texture, Texture::Encoding::srgb),
                      find(material.metallic_roughness_texture, Texture::Encoding::linear),
                      find(material.alpha_texture, Texture::Encoding::linear),
                      find(material.normal_texture, Texture::Encoding::linear)});
  return result;
}

std::vector<std::shared_ptr<const Texture>> load_light_textures(const Scene& scene, bool strict,
                                                                std::vector<std::string>& notes) {
  std::vector<std::shared_ptr<const Texture>> result(scene.lights.size());
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const auto* light = std::get_if<EnvironmentLight>(&scene.lights[i]);
    if (light == nullptr || light->texture.empty()) continue;
    Slot slot = read(scene, {light->texture, Texture::Encoding::srgb});
    if (slot.texture && light->mapping == EnvironmentLight::Mapping::equal_area &&
        slot.texture->width() != slot.texture->height())
      slot = {nullptr, light->texture + ": is not square, as pictures of an equal-area environment are"};
    if (!slot.texture && strict) throw Error(slot.code, "", slot.failure);
    if (!slot.texture) notes.push_back("environment picture left out: " + slot.failure);
    result[i] = std::move(slot.texture);
  }
  return result;
}

}  // namespace kairos
