#include "shading/shader.h"

#include <cmath>

#include "shading/surface.h"

namespace kairos {

Shader::Shader(const Shot& shot, ShadingKind kind, bool want_normal)
    : shot_(shot), kind_(kind), want_normal_(want_normal || kind == ShadingKind::normal) {
  const Material fallback;  // for a shot made by hand, without materials
  for (const Mesh& mesh : shot.meshes) {
    const Material& material = mesh.material < shot.materials.size() ? shot.materials[mesh.material] : fallback;
    const bool still = mesh.is_static() && mesh.normals.size() < 2 && !shot.camera_moves;
    looks_.push_back({material.base_color, material.emission, want_normal_ && !still});
  }
  if (!shot.world_from_camera)
    world_from_camera_ = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  else if (!shot.camera_moves)
    world_from_camera_ = shot.world_from_camera(0);
}

Vec3f Shader::normal(const Ray& ray, uint32_t mesh_index, uint32_t triangle, float time) const {
  const Mesh& mesh = shot_.meshes[mesh_index];
  const std::array<Vec3d, 3> vertices = triangle_at(mesh, triangle, time);
  if (!mesh.normals.empty()) {
    const Vec3f own = interpolated_normal(mesh, triangle, barycentrics(vertices, ray), time);
    if (own != Vec3f{}) return own;
  }
  const Vec3d n = geometric_normal(vertices);
  const auto axes = world_from_camera_ ? *world_from_camera_ : shot_.world_from_camera(static_cast<double>(time));
  return to_float(normalize(axes[0] * n.x + axes[1] * n.y + axes[2] * n.z));
}

Shade Shader::shade(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
  Shade shade;
  shade.albedo = looks_[mesh].base_colour;
  if (want_normal_) shade.normal = normal(ray, mesh, triangle, time);
  switch (kind_) {
    case ShadingKind::normal:
      shade.colour = {std::abs(shade.normal.x), std::abs(shade.normal.y), std::abs(shade.normal.z)};
      break;
    case ShadingKind::flat:
      shade.colour = looks_[mesh].base_colour + looks_[mesh].emission;
      break;
  }
  return shade;
}

}  // namespace kairos
