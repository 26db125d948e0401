// What materials, their pictures and the colours of vertices say about a point of a surface.
#pragma once

#include <array>
#include <vector>

#include <kairos/scene.h>

namespace kairos {

struct Look {
  Vec3f base_colour, emission;  ///< linear
  float alpha = 1, metallic = 0, roughness = 1;
};

/// Alpha, and where in the picture it comes from, in texels of the copy looked at.
struct AlphaPoint {
  float alpha = 1;
  Vec2f place;
};

/// Reads the shot, which must outlive it. Safe to use from many threads at once.
class Looks {
 public:
  explicit Looks(const Shot& shot);

  const Material& material(uint32_t mesh) const { return *entries_[mesh].material; }
  /// False when the mesh looks the same all over, but for which way it faces.
  bool varies(uint32_t mesh) const { return entries_[mesh].varies; }

  bool alpha_varies(uint32_t mesh) const { return alpha_picture(mesh) || has_vertex_alpha(mesh); }
  /// Do the colours of vertices make part of the mesh transparent?
  bool has_vertex_alpha(uint32_t mesh) const { return entries_[mesh].has_vertex_alpha; }
  bool has_emission_texture(uint32_t mesh) const { return entries_[mesh].emission.texture; }
  bool has_normal_texture(uint32_t mesh) const { return entries_[mesh].normal.texture; }

  /// vertices: the triangle's at that instant; weights: barycentric, of the point. width: of the piece of surface that
  /// the look stands for, in scene units. It decides how fine a copy of each picture is looked at. A pixel that sees a
  /// surface at a slant sees a longer piece than a wide one: the width is meant, since what is too fine along the
  /// length is averaged over the pixel's samples.
  Look at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices, const std::array<float, 3>& weights,
          double width) const;

  /// The same for alpha alone.
  AlphaPoint alpha_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                      const std::array<float, 3>& weights, double width) const;

  /// Of a mesh with a normal picture: what it says, from -1 to 1 before Material::normal_scale, of any length but for
  /// rounding.
  Vec3f normal_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                  const std::array<float, 3>& weights, double width) const;
  /// Where the corners of a triangle lie on the mesh's normal picture.
  std::array<Vec2f, 3> normal_uvs(uint32_t mesh, uint32_t triangle) const;

 private:
  /// A picture of a mesh's material, and the coordinates that it takes.
  struct Slot {
    const Texture* texture = nullptr;  // nullptr for none
    const TextureRef* ref = nullptr;
    const std::vector<Vec2f>* uvs = nullptr;
    bool nearest = false;
  };
  struct Entry {
    const Material* material;
    Slot base_color, emission, metallic_roughness, alpha, normal;
    bool varies = false, has_vertex_alpha = false;
  };
  class Point;

  /// The slot that alpha comes from: an alpha picture's red, or the base colour's alpha; nullptr for none.
  const Slot* alpha_picture(uint32_t mesh) const;
  Vec4f vertex_colour(uint32_t mesh, uint32_t triangle, const std::array<float, 3>& weights) const;

  const Shot& shot_;
  Material fallback_;           // for a shot made by hand, without materials
  std::vector<Entry> entries_;  // [mesh]
};

}  // namespace kairos
