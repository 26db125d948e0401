#include "shading/looks.h"

#include <algorithm>
#include <cmath>

#include "image/texture.h"

namespace kairos {

namespace {

/// How many units of (u, v) a unit of length on the triangle is, in the mean over directions.
double uv_per_length(const std::array<Vec3d, 3>& vertices, const std::array<Vec2f, 3>& uvs) {
  const double area = length(cross(vertices[1] - vertices[0], vertices[2] - vertices[0]));
  const Vec2d a{uvs[1].x - uvs[0].x, uvs[1].y - uvs[0].y}, b{uvs[2].x - uvs[0].x, uvs[2].y - uvs[0].y};
  return area > 0 ? std::sqrt(std::abs(a.x * b.y - a.y * b.x) / area) : 0;
}

Texel look_up(const Texture& texture, const Material& material, Vec2f uv, double uv_width) {
  const double texels = std::sqrt(static_cast<double>(texture.width()) * texture.height());
  return texture.at(uv, static_cast<float>(uv_width * texels), material.texture_wrap);
}

}  // namespace

Looks::Looks(const Shot& shot) : shot_(shot) {
  for (const Mesh& mesh : shot.meshes) {
    const Material& material = mesh.material < shot.materials.size() ? shot.materials[mesh.material] : fallback_;
    const MaterialTextures* textures =
        mesh.material < shot.textures.size() && !mesh.uvs.empty() ? &shot.textures[mesh.material] : nullptr;
    const bool is_textured =
        textures && (textures->base_color || textures->emission || textures->metallic_roughness || textures->alpha);
    entries_.push_back({&material, is_textured ? textures : nullptr, is_textured});
  }
}

Look Looks::at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
               const std::array<float, 3>& weights, double width) const {
  const Entry& entry = entries_[mesh];
  const Material& material = *entry.material;
  Look look{material.base_color, material.emission, material.alpha, material.metallic, material.roughness};
  if (!entry.is_textured) return look;
  const Triangle& corners = shot_.meshes[mesh].triangles[triangle];
  std::array<Vec2f, 3> uvs;
  Vec2f uv{};
  for (size_t i = 0; i < 3; ++i) {
    uvs[i] = shot_.meshes[mesh].uvs[corners[i]];
    uv = {uv.x + uvs[i].x * weights[i], uv.y + uvs[i].y * weights[i]};
  }
  const double uv_width = width * uv_per_length(vertices, uvs);
  if (entry.textures->base_color) {
    const Texel texel = look_up(*entry.textures->base_color, material, uv, uv_width);
    look.base_colour = look.base_colour * texel.colour;
    if (!entry.textures->alpha) look.alpha *= texel.alpha;
  }
  if (entry.textures->alpha) look.alpha *= look_up(*entry.textures->alpha, material, uv, uv_width).colour.x;
  if (entry.textures->emission && look.emission != Vec3f{})
    look.emission = look.emission * look_up(*entry.textures->emission, material, uv, uv_width).colour;
  if (entry.textures->metallic_roughness) {
    const Texel texel = look_up(*entry.textures->metallic_roughness, material, uv, uv_width);
    look.roughness *= texel.colour.y;
    look.metallic *= texel.colour.z;
  }
  return look;
}

bool Looks::has_alpha_texture(uint32_t mesh) const {
  if (!is_textured(mesh)) return false;
  const MaterialTextures& textures = *entries_[mesh].textures;
  return textures.alpha || (textures.base_color && textures.base_color->has_alpha());
}

AlphaPoint Looks::alpha_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                           const std::array<float, 3>& weights, double width) const {
  AlphaPoint point{entries_[mesh].material->alpha, {}};
  if (!has_alpha_texture(mesh)) return point;
  const Texture* own = entries_[mesh].textures->alpha.get();
  const Texture& texture = own ? *own : *entries_[mesh].textures->base_color;
  const Triangle& corners = shot_.meshes[mesh].triangles[triangle];
  std::array<Vec2f, 3> uvs;
  Vec2f uv{};
  for (size_t i = 0; i < 3; ++i) {
    uvs[i] = shot_.meshes[mesh].uvs[corners[i]];
    uv = {uv.x + uvs[i].x * weights[i], uv.y + uvs[i].y * weights[i]};
  }
  const double texels = std::sqrt(static_cast<double>(texture.width()) * texture.height());
  const auto footprint = static_cast<float>(width * uv_per_length(vertices, uvs) * texels);
  const Texel texel = texture.at(uv, footprint, entries_[mesh].material->texture_wrap);
  point.alpha *= own ? texel.colour.x : texel.alpha;
  const float scale = 1 / std::max(1.0f, footprint);
  point.place = {uv.x * static_cast<float>(texture.width()) * scale,
                 uv.y * static_cast<float>(texture.height()) * scale};
  return point;
}

}  // namespace kairos
