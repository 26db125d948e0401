// What materials and their pictures say about a point of a surface.
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
  /// False when the mesh looks the same all over.
  bool is_textured(uint32_t mesh) const { return entries_[mesh].is_textured; }

  bool has_alpha_texture(uint32_t mesh) const;
  bool has_emission_texture(uint32_t mesh) const { return is_textured(mesh) && entries_[mesh].textures->emission; }

  /// vertices: the triangle's at that instant; weights: barycentric, of the point. width: of the piece of surface that
  /// the look stands for, in scene units. It decides how fine a copy of each picture is looked at. A pixel that sees a
  /// surface at a slant sees a longer piece than a wide one: the width is meant, since what is too fine along the
  /// length is averaged over the pixel's samples.
  Look at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices, const std::array<float, 3>& weights,
          double width) const;

  /// The same for alpha alone.
  AlphaPoint alpha_at(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                      const std::array<float, 3>& weights, double width) const;

 private:
  struct Entry {
    const Material* material;
    const MaterialTextures* textures;  // nullptr for none
    bool is_textured;
  };

  const Shot& shot_;
  Material fallback_;           // for a shot made by hand, without materials
  std::vector<Entry> entries_;  // [mesh]
};

}  // namespace kairos
