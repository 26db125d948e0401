#include "scene_io/pbrt/look.h"

namespace kairos::pbrt {

uint32_t SceneLooks::material_of(const Look& look, Vec3f emitted) {
  const Alpha& alpha = look.alpha;
  const bool one_sided = look.light && !look.light->two_sided;
  const auto& [u, v] = alpha.image.placement;
  const Key key{look.surface,        {emitted.x, emitted.y, emitted.z}, look.light != nullptr, one_sided,
                alpha.image.picture, {u.x, u.y, u.z, v.x, v.y, v.z},    alpha.image.wrap[0],   alpha.value};
  const auto [found, is_new] = indices_.try_emplace(key, static_cast<uint32_t>(materials_.size()));
  if (!is_new) return found->second;
  Material material = look.surface->material;
  if (look.surface->invisible) material.base_color = {};
  material.emission = emitted;
  material.one_sided_emission = one_sided;
  material.lamp = look.light != nullptr;
  if (look.light && alpha.value == 0) {  // pbrt-v4's invisible lights
    material.alpha = 0;
    material.alpha_mode = Material::AlphaMode::mask;
    material.emits_where_cut_out = true;
  } else if (!alpha.image.empty()) {
    if (material.alpha_mode == Material::AlphaMode::opaque) material.alpha_mode = Material::AlphaMode::mask;
    material.alpha_texture = alpha.image;
  } else if (alpha.value < 1) {
    material.alpha_mode = Material::AlphaMode::blend;
    material.alpha *= static_cast<float>(alpha.value);
  }
  materials_.push_back(std::move(material));
  return found->second;
}

}  // namespace kairos::pbrt
