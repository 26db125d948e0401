// The colour of what a ray sees at an instant.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <kairos/render.h>

#include "shading/looks.h"
#include "shading/pixel_cone.h"

namespace kairos {

struct Shade {
  Vec3f colour;  ///< linear, scene-referred
  Vec3f normal;  ///< unit, world space; zero where undefined, or when nothing asked for it
  Vec3f albedo;
};

/// Reads the shot, which must outlive it. Safe to use from many threads at once.
class Shader {
 public:
  /// want_normal: fill Shade::normal even where the colour does not need it.
  Shader(const Shot& shot, ShadingKind kind, bool want_normal);

  /// time: shutter time at which the ray sees the triangle.
  Shade shade(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;

  /// False when all instants at which a ray sees one of the mesh's triangles look the same.
  bool varies(uint32_t mesh) const { return varies_[mesh]; }

 private:
  Vec3f normal(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;
  Look look(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;

  const Shot& shot_;
  Looks looks_;
  PixelCone cone_;
  std::vector<bool> varies_;  // [mesh]
  ShadingKind kind_;
  bool want_normal_;
  std::optional<std::array<Vec3d, 3>> world_from_camera_;  // when the camera stands still
};

}  // namespace kairos
