#include "scene/load_textures.h"

#include <map>
#include <new>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/printable.h>

#include "base/file.h"
#include "base/parallel.h"
#include "image/pixels.h"
#include "image/texture.h"

namespace kairos {

namespace {

constexpr uint64_t kMostSteps = uint64_t{1} << 62;

struct Slot {
  uint64_t file_bytes = 0;
  PictureCost cost;
  std::shared_ptr<const Texture> texture;
  std::string failure;  // why there is none
  ErrorCode code = ErrorCode::bad_input;
};

using Key = std::pair<std::string, Texture::Encoding>;
using Slots = std::map<Key, Slot>;

/// use(bytes) with those of an encoded picture.
template <class Use>
auto with_bytes(const Scene& scene, const std::string& name, const Use& use) {
  const auto embedded = scene.embedded_pictures.find(name);
  if (embedded != scene.embedded_pictures.end()) return use(std::span<const uint8_t>(embedded->second));
  const std::vector<uint8_t> bytes = read_file(name, kMaxPictureFileBytes);
  return use(std::span<const uint8_t>(bytes));
}

/// Does `work`, and keeps what goes wrong with the picture. Where memory ends, nothing is left out: the program does.
template <class Work>
void attempt(Slot& slot, const Work& work) {
  try {
    work();
  } catch (const Error& e) {
    slot.failure = e.what();
    slot.code = e.code();
  }
}

/// With its coarser copies, and what they are made from.
PictureCost with_pyramid(PictureCost cost) {
  cost.bytes += cost.bytes / 3;
  return cost;
}

/// Reads all pictures: first what each would take, then, of those that may have it, their pixels. Files are read twice,
/// so that no more than those at work are in memory.
void read(const Scene& scene, Slots& slots, MemoryBudget& budget) {
  std::vector<std::pair<const Key, Slot>*> all;
  for (auto& slot : slots) all.push_back(&slot);
  const auto for_each = [&](const auto& work) {
    parallel_for(all.size(), 1, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) attempt(all[i]->second, [&] { work(all[i]->first, all[i]->second); });
    });
  };
  const auto is_decoded = [&](const Key& key) { return scene.pictures.count(key.first) > 0; };
  for_each([&](const Key& key, Slot& slot) {
    if (is_decoded(key)) return;
    slot.cost = with_bytes(scene, key.first, [&](std::span<const uint8_t> bytes) {
      slot.file_bytes = bytes.size();
      return with_pyramid(picture_cost(bytes, key.first));
    });
  });
  for (const auto* slot : all)
    if (scene.embedded_pictures.count(slot->first.first) == 0) budget.add_file(slot->second.file_bytes);
  // Work is granted with memory: a picture of an honest file that comes in many scans is no more than so much of it.
  constexpr uint64_t kStepsPerByte = 2;
  uint64_t steps = budget.left() > kMostSteps / kStepsPerByte ? kMostSteps : budget.left() * kStepsPerByte;
  for (auto* entry : all) {
    const std::string& name = entry->first.first;
    Slot& slot = entry->second;
    if (!slot.failure.empty() || is_decoded(entry->first)) continue;
    if (slot.cost.steps <= steps && budget.take(slot.cost.bytes)) {
      steps -= slot.cost.steps;
      continue;
    }
    slot.failure = fmt::format(
        "{}: {}x{} pixels in a file of {} bytes take more memory or work than the scene's files leave; if they "
        "are to be trusted, raise --memory-budget",
        name, slot.cost.width, slot.cost.height, slot.file_bytes);
  }
  for_each([&](const Key& key, Slot& slot) {
    if (!slot.failure.empty()) return;
    const std::string& name = key.first;
    const Texture::Encoding encoding = key.second;
    if (is_decoded(key)) {
      slot.texture = std::make_shared<const Texture>(scene.pictures.find(name)->second, encoding);
      return;
    }
    Pixels pixels = with_bytes(scene, name, [&](std::span<const uint8_t> bytes) {
      const PictureCost now = with_pyramid(picture_cost(bytes, name));
      if (now.bytes > slot.cost.bytes || now.steps > slot.cost.steps)
        throw Error(ErrorCode::io, name, "has changed while it was read");
      return decode_picture(bytes, name);
    });
    slot.texture = std::make_shared<const Texture>(std::move(pixels), encoding);
  });
}

/// One note of all meshes that lack the coordinates which a picture of their material takes; an error if strict.
void report_missing_coordinates(const Scene& scene, const std::vector<MaterialTextures>& textures, bool strict,
                                std::vector<std::string>& notes) {
  std::string first;
  size_t meshes = 0;
  for (const SceneMesh& mesh : scene.meshes) {
    if (mesh.material >= textures.size()) continue;
    const Material& m = scene.materials[mesh.material];
    const MaterialTextures& t = textures[mesh.material];
    const auto lacks = [&](const std::shared_ptr<const Texture>& texture, const TextureRef& ref) {
      const size_t set = ref.uv_set;
      const bool is_there =
          set == 0 ? !mesh.uvs.empty() : set <= mesh.more_uvs.size() && !mesh.more_uvs[set - 1].empty();
      if (!texture || is_there) return false;
      if (meshes == 0)
        first = fmt::format("mesh '{}' has no texture coordinates (set {}) for '{}'", printable(mesh.name), set,
                            printable(ref.picture));
      return true;
    };
    if (lacks(t.base_color, m.base_color_texture) || lacks(t.emission, m.emission_texture) ||
        lacks(t.metallic_roughness, m.metallic_roughness_texture) || lacks(t.alpha, m.alpha_texture) ||
        lacks(t.normal, m.normal_texture))
      ++meshes;
  }
  if (meshes == 0) return;
  if (meshes > 1) first += fmt::format(", nor have {} other meshes for theirs", meshes - 1);
  if (strict) throw Error(ErrorCode::bad_input, "", first);
  notes.push_back("texture left out: " + first);
}

}  // namespace

std::vector<MaterialTextures> load_textures(const Scene& scene, bool cut_outs_only, bool strict, MemoryBudget& budget,
                                            std::vector<std::string>& notes) {
  Slots slots;
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

  read(scene, slots, budget);
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
  report_missing_coordinates(scene, result, strict, notes);
  return result;
}

std::vector<std::shared_ptr<const Texture>> load_light_textures(const Scene& scene, std::span<const Light> lights,
                                                                bool strict, MemoryBudget& budget,
                                                                std::vector<std::string>& notes) {
  std::vector<std::shared_ptr<const Texture>> result(lights.size());
  Slots slots;
  for (const Light& light : lights)
    if (const auto* sky = std::get_if<EnvironmentLight>(&light); sky != nullptr && !sky->texture.empty())
      slots.try_emplace({sky->texture, Texture::Encoding::srgb});
  read(scene, slots, budget);
  for (size_t i = 0; i < lights.size(); ++i) {
    const auto* light = std::get_if<EnvironmentLight>(&lights[i]);
    if (light == nullptr || light->texture.empty()) continue;
    Slot slot = slots.at({light->texture, Texture::Encoding::srgb});
    if (slot.texture && light->mapping == EnvironmentLight::Mapping::equal_area &&
        slot.texture->width() != slot.texture->height()) {
      slot.texture = nullptr;
      slot.failure = light->texture + ": is not square, as pictures of an equal-area environment are";
    }
    if (!slot.texture && strict) throw Error(slot.code, "", slot.failure);
    if (!slot.texture) notes.push_back("environment picture left out: " + slot.failure);
    result[i] = std::move(slot.texture);
  }
  return result;
}

}  // namespace kairos
