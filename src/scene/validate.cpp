#include <cmath>
#include <initializer_list>
#include <set>
#include <string>

#include <kairos/error.h>
#include <kairos/mesh.h>
#include <kairos/scene.h>

#include "camera/film_plane.h"
#include "scene/instances.h"

namespace kairos {

namespace {
[[noreturn]] void broken(const Mesh& mesh, const std::string& what) {
  throw Error(ErrorCode::bad_input, "mesh '" + mesh.name + "'", what);
}

void require(bool holds, const std::string& where, const char* what) {
  if (!holds) throw Error(ErrorCode::bad_input, where, what);
}

bool all_finite(std::initializer_list<float> numbers) {
  for (const float number : numbers)
    if (!std::isfinite(number)) return false;
  return true;
}

bool is_finite(const TextureRef& texture) { return is_finite(texture.placement[0]) && is_finite(texture.placement[1]); }

bool is_finite(const Material& m) {
  return is_finite(m.base_color) && is_finite(m.emission) && is_finite(m.specular_color) &&
         is_finite(m.base_color_texture) && is_finite(m.emission_texture) && is_finite(m.metallic_roughness_texture) &&
         is_finite(m.alpha_texture) && is_finite(m.normal_texture) &&
         all_finite({m.metallic, m.roughness, m.specular, m.clearcoat, m.clearcoat_roughness, m.transmission, m.ior,
                     m.alpha, m.alpha_cutoff, m.normal_scale});
}

bool is_finite(const PointLight& light) { return is_finite(light.position) && is_finite(light.intensity); }
bool is_finite(const SpotLight& light) {
  return is_finite(light.position) && is_finite(light.direction) && is_finite(light.intensity) &&
         all_finite({light.cos_inner, light.cos_outer});
}
bool is_finite(const DirectionalLight& light) { return is_finite(light.direction) && is_finite(light.irradiance); }
bool is_finite(const ConstantLight& light) { return is_finite(light.radiance); }
bool is_finite(const EnvironmentLight& light) {
  return is_finite(light.radiance) && is_finite(light.axes[0]) && is_finite(light.axes[1]) && is_finite(light.axes[2]);
}
}  // namespace

namespace {

void check_key_times(const Mesh& mesh) {
  const size_t keys = mesh.key_count();
  if (keys < 2) return;
  if (mesh.key_times.size() != keys)
    broken(mesh, "has " + std::to_string(keys) + " keys but " + std::to_string(mesh.key_times.size()) + " key times");
  if (mesh.key_times.front() != 0 || mesh.key_times.back() != 1) broken(mesh, "key times must run from 0 to 1");
  for (size_t k = 1; k < keys; ++k)
    if (!(mesh.key_times[k - 1] <= mesh.key_times[k])) broken(mesh, "key times must ascend");
}

/// What an instance has beside its object, which is valid; corners: of the object's box.
void check_instance(const Mesh& mesh, const std::array<Vec3f, 8>& corners) {
  const Mesh& object = *mesh.object;
  if (object.object || object.key_count() != 1)
    broken(mesh, "its object must be a mesh with one key, and no instance itself");
  if (!mesh.triangles.empty() || !mesh.positions.empty()) broken(mesh, "is an instance, and has geometry of its own");
  if (mesh.key_count() == 0) broken(mesh, "is an instance that nothing places");
  check_key_times(mesh);
  for (const AffineMap& map : mesh.placements)
    for (const Vec3f& corner : corners)
      if (!is_finite(map.point(corner))) broken(mesh, "a position is not finite");
  const size_t directions = mesh.directions.size();
  const bool needed = !object.normals.empty() || !object.tangents.empty();
  if (needed && directions != 1 && directions != mesh.key_count())
    broken(mesh, "directions need one key, or as many as placements");
}

}  // namespace

void validate_meshes(std::span<const Mesh> meshes) {
  ObjectCorners corners;
  std::set<const Mesh*> objects;
  for (const Mesh& mesh : meshes) {
    if (!mesh.object) {
      validate_mesh(mesh);
      continue;
    }
    if (objects.insert(mesh.object.get()).second) validate_mesh(*mesh.object);
    check_instance(mesh, corners.of(*mesh.object));
  }
}

void validate_mesh(const Mesh& mesh) {
  if (mesh.object) return validate_meshes({&mesh, 1});
  const size_t keys = mesh.key_count(), vertices = mesh.vertex_count();
  if (keys == 0 && !mesh.triangles.empty()) broken(mesh, "has triangles but no positions");
  check_key_times(mesh);
  for (const auto& key : mesh.positions) {
    if (key.size() != vertices) broken(mesh, "its keys differ in their number of vertices");
    for (const Vec3f& p : key)
      if (!is_finite(p)) broken(mesh, "a position is not finite");
  }
  if (!mesh.normals.empty()) {
    if (mesh.normals.size() != 1 && mesh.normals.size() != keys)
      broken(mesh, "normals need one key, or as many as positions");
    for (const auto& key : mesh.normals)
      if (key.size() != vertices) broken(mesh, "needs one normal per vertex");
  }
  if (!mesh.tangents.empty()) {
    if (mesh.tangents.size() != 1 && mesh.tangents.size() != keys)
      broken(mesh, "tangents need one key, or as many as positions");
    for (const auto& key : mesh.tangents)
      if (key.size() != vertices) broken(mesh, "needs one tangent per vertex");
  }
  for (uint32_t set = 0; set <= mesh.more_uvs.size(); ++set)
    if (!mesh.uv_set(set).empty() && mesh.uv_set(set).size() != vertices)
      broken(mesh, "needs one texture coordinate per vertex");
  if (!mesh.colors.empty() && mesh.colors.size() != vertices) broken(mesh, "needs one colour per vertex");
  for (const Vec4f& c : mesh.colors)
    if (!all_finite({c.x, c.y, c.z, c.w})) broken(mesh, "a vertex's colour is not finite");
  if (!mesh.prim_ids.empty() && mesh.prim_ids.size() != mesh.triangles.size())
    broken(mesh, "needs one number per triangle");
  for (const Triangle& t : mesh.triangles)
    for (uint32_t v : t)
      if (v >= vertices)
        broken(mesh, "index " + std::to_string(v) + " is beyond its " + std::to_string(vertices) + " vertices");
}

void validate_shot(const Shot& shot) {
  validate_meshes(shot.meshes);
  for (const Mesh& mesh : shot.meshes) {
    if (!shot.materials.empty() && mesh.material >= shot.materials.size())
      broken(mesh, "its material " + std::to_string(mesh.material) + " is beyond the shot's " +
                       std::to_string(shot.materials.size()) + " materials");
  }
  for (const Material& material : shot.materials)
    require(is_finite(material), "material '" + material.name + "'", "a number is not finite");
  require(shot.textures.empty() || shot.textures.size() == shot.materials.size(), "textures",
          "the shot needs as many entries as it has materials, or none");
  for (size_t i = 0; i < shot.lights.size(); ++i)
    require(std::visit([](const auto& light) { return is_finite(light); }, shot.lights[i]),
            "light " + std::to_string(i), "a number is not finite");
  require(shot.light_textures.empty() || shot.light_textures.size() == shot.lights.size(), "light textures",
          "the shot needs as many entries as it has lights, or none");
  require(shot.moving_lights.empty() || shot.moving_lights.size() == shot.lights.size(), "moving lights",
          "the shot needs as many entries as it has lights, or none");
  require(is_finite(shot.background), "background", "is not finite");
  require(shot.brightest > 0, "brightest", "is not above 0");
  require(!shot.backdrop || is_finite(*shot.backdrop), "backdrop", "is not finite");
  require(shot.projection.width > 0 && shot.projection.height > 0, "projection",
          "shows nothing: it needs a positive width and height in pixels");
  check_lens(shot.projection, "projection");
}

}  // namespace kairos
