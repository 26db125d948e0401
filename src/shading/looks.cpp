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

double texels_per_uv(const Texture& texture) {
  return std::sqrt(static_cast<double>(texture.width()) * texture.height());
}

/// A few colours next to each other (TextureRef::nearest).
bool is_swatches(const Texture& texture) {
  constexpr int64_t kMostTexels = 16;
  return static_cast<int64_t>(texture.width()) * texture.height() <= kMostTexels;
}

}  // namespace

/// A point of a triangle on the pictures of its material. Most materials have all of their pictures lie in the same
/// way, so the last place is kept.
class Looks::Point {
 public:
  Point(const Triangle& corners, const std::array<Vec3d, 3>& vertices, const std::array<float, 3>& weights,
        double width)
      : corners_(corners), vertices_(vertices), weights_(weights), width_(width) {}

  Texel look_up(const Slot& slot) {
    move_to(slot);
    return slot.texture->at(uv_, footprint(*slot.texture), slot.ref->wrap, slot.nearest);
  }

  /// Of the last picture looked up.
  Vec2f uv() const { return uv_; }
  float footprint(const Texture& texture) const { return static_cast<float>(uv_width_ * texels_per_uv(texture)); }

 private:
  void move_to(const Slot& slot) {
    if (uvs_ == slot.uvs && placement_ == slot.ref->placement) return;
    uvs_ = slot.uvs;
    placement_ = slot.ref->placement;
    uv_ = {};
    std::array<Vec2f, 3> placed;
    for (size_t i = 0; i < 3; ++i) {
      placed[i] = slot.ref->place((*uvs_)[corners_[i]]);
      uv_ = {uv_.x + placed[i].x * weights_[i], uv_.y + placed[i].y * weights_[i]};
    }
    uv_width_ = width_ * uv_per_length(vertices_, placed);
  }

  const Triangle& corners_;
  const std::array<Vec3d, 3>& vertices_;
  const std::array<float, 3>& weights_;
  const double width_;
  const std::vector<Vec2f>* uvs_ = nullptr;
  std::array<Vec3f, 2> placement_;
  Vec2f uv_{};
  double uv_width_ = 0;
};

Looks::Looks(const Shot& shot) : shot_(shot) {
  for (const Mesh& mesh : shot.meshes) {
    const Material& material = mesh.material < shot.materials.size() ? shot.materials[mesh.material] : fallback_;
    Entry entry;
    entry.material = &material;
    if (mesh.material < shot.textures.size()) {
      const MaterialTextures& textures = shot.textures[mesh.material];
      const auto slot = [&](const std::shared_ptr<const Texture>& texture, const TextureRef& ref) -> Slot {
        const std::vector<Vec2f>& uvs = mesh.uv_set(ref.uv_set);
        if (!texture || uvs.empty()) return {};
        return {texture.get(), &ref, &uvs, ref.nearest.value_or(is_swatches(*texture))};
      };
      entry.base_color = slot(textures.base_color, material.base_color_texture);
      entry.emission = slot(textures.emission, material.emission_texture);
      entry.metallic_roughness = slot(textures.metallic_roughness, material.metallic_roughness_texture);
      entry.alpha = slot(textures.alpha, material.alpha_texture);
      entry.normal = slot(textures.normal, material.normal_texture);
    }
    entry.varies = entry.base_color.texture || entry.emission.texture || entry.metallic_roughness.texture ||
                   entry.alpha.texture || !mesh.shape().colors.empty();
    entry.has_vertex_alpha = std::any_of(mesh.shape().colors.begin(), mesh.shape().colors.end(),
                                         [](const Vec4f& colour) { return colour.w != 1; });
    entries_.push_back(entry);
  }
}

Vec4f Looks::vertex_colour(uint32_t mesh, uint32_t triangle, const std::array<float, 3>& weights) const {
  const Triangle& corners = shot_.meshes[mesh].triangle(triangle);
  const std::vector<Vec4f>& colors = shot_.meshes[mesh].shape().colors;
  const Vec4f &a = colors[corners[0]], &b = colors[corners[1]], &c = colors[corners[2]];
  // As differences from the first corner: what is even stays so, to the bit.
  const auto mix = [&](float p, float q, float r) { return p + (q - p) * weights[1] + (r - p) * weights[2]; };
  return {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z), mix(a.w, b.w, c.w)};
}

Look Looks::at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
               const std::array<float, 3>& weights, double width) const {
  const Entry& entry = entries_[mesh];
  const Material& material = *entry.material;
  Look look{material.base_color, material.emission, material.alpha, material.metallic, material.roughness};
  if (!entry.varies) return look;
  Point point(shot_.meshes[mesh].triangle(triangle), vertices, weights, width);
  if (!shot_.meshes[mesh].shape().colors.empty()) {
    const Vec4f colour = vertex_colour(mesh, triangle, weights);
    look.base_colour = look.base_colour * Vec3f{colour.x, colour.y, colour.z};
    look.alpha *= colour.w;
  }
  if (entry.base_color.texture) {
    const Texel texel = point.look_up(entry.base_color);
    look.base_colour = look.base_colour * texel.colour;
    if (!entry.alpha.texture) look.alpha *= texel.alpha;
  }
  if (entry.alpha.texture) look.alpha *= point.look_up(entry.alpha).colour.x;
  if (entry.emission.texture && look.emission != Vec3f{})
    look.emission = look.emission * point.look_up(entry.emission).colour;
  if (entry.metallic_roughness.texture) {
    const Texel texel = point.look_up(entry.metallic_roughness);
    look.roughness *= texel.colour.y;
    look.metallic *= texel.colour.z;
  }
  return look;
}

const Looks::Slot* Looks::alpha_picture(uint32_t mesh) const {
  const Entry& entry = entries_[mesh];
  if (entry.alpha.texture) return &entry.alpha;
  return entry.base_color.texture && entry.base_color.texture->has_alpha() ? &entry.base_color : nullptr;
}

AlphaPoint Looks::alpha_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                           const std::array<float, 3>& weights, double width) const {
  const Entry& entry = entries_[mesh];
  AlphaPoint result{entry.material->alpha, {}};
  if (entry.has_vertex_alpha) result.alpha *= vertex_colour(mesh, triangle, weights).w;
  const Slot* slot = alpha_picture(mesh);
  if (!slot) return result;
  Point point(shot_.meshes[mesh].triangle(triangle), vertices, weights, width);
  const Texel texel = point.look_up(*slot);
  result.alpha *= slot == &entry.alpha ? texel.colour.x : texel.alpha;
  const float scale = 1 / std::max(1.0f, point.footprint(*slot->texture));
  result.place = {point.uv().x * static_cast<float>(slot->texture->width()) * scale,
                  point.uv().y * static_cast<float>(slot->texture->height()) * scale};
  return result;
}

Vec3f Looks::normal_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                       const std::array<float, 3>& weights, double width) const {
  Point point(shot_.meshes[mesh].triangle(triangle), vertices, weights, width);
  const Vec3f code = point.look_up(entries_[mesh].normal).colour;
  return code * 2.0f - Vec3f{1, 1, 1};
}

std::array<Vec2f, 3> Looks::normal_uvs(uint32_t mesh, uint32_t triangle) const {
  const Slot& slot = entries_[mesh].normal;
  const Triangle& corners = shot_.meshes[mesh].triangle(triangle);
  std::array<Vec2f, 3> uvs;
  for (size_t i = 0; i < 3; ++i) uvs[i] = slot.ref->place((*slot.uvs)[corners[i]]);
  return uvs;
}

}  // namespace kairos
