// kairos/kairos.h: scenes from memory.
#include <kairos/make_scene.h>

#include "c_interface/handles.h"

namespace kairos::c_interface {

namespace {

Vec3f vector_of(const float (&from)[3]) { return {from[0], from[1], from[2]}; }

MeshDescription description_of(const kairos_mesh& given) {
  const kairos_mesh from = taken(&given, "mesh");
  Mesh mesh = mesh_of(given);
  MeshDescription out;
  out.name = mesh.name;
  out.triangles = std::move(mesh.triangles);
  out.times.assign(mesh.key_times.begin(), mesh.key_times.end());
  out.positions = std::move(mesh.positions);
  out.material = mesh.material;
  if (from.normals != nullptr)
    for (size_t k = 0; k < out.positions.size(); ++k) {
      const float* const first = from.vertex_count > 0 ? &needed(from.normals[k], "normals") : nullptr;
      std::vector<Vec3f>& key = out.normals.emplace_back();
      for (size_t i = 0; i < from.vertex_count; ++i) key.push_back({first[3 * i], first[3 * i + 1], first[3 * i + 2]});
    }
  if (from.uvs != nullptr)
    for (size_t i = 0; i < from.vertex_count; ++i) out.uvs.push_back({from.uvs[2 * i], from.uvs[2 * i + 1]});
  return out;
}

Material material_of(const kairos_material& given) {
  const kairos_material from = taken(&given, "material");
  Material material;
  take(from.name, material.name);
  material.double_sided = from.one_sided == 0;
  material.unlit = from.unlit != 0;
  if (from.alpha_mode < KAIROS_OPAQUE || from.alpha_mode > KAIROS_BLEND)
    refuse("alpha_mode", "is none of KAIROS_OPAQUE, KAIROS_MASK and KAIROS_BLEND");
  material.alpha_mode = static_cast<Material::AlphaMode>(from.alpha_mode);
  take(from.base_color_picture, material.base_color_texture.picture);
  material.base_color = vector_of(from.base_color);
  material.emission = vector_of(from.emission);
  material.metallic = from.metallic;
  material.roughness = from.roughness;
  material.transmission = from.transmission;
  material.ior = from.ior;
  material.alpha = from.alpha;
  material.alpha_cutoff = from.alpha_cutoff;
  return material;
}

CameraDescription camera_of(const kairos_camera& given) {
  const kairos_camera from = taken(&given, "camera");
  constexpr double kRadians = 3.14159265358979323846 / 180;
  CameraDescription camera;
  take(from.name, camera.name);
  camera.orthographic = from.orthographic != 0;
  if (from.vfov_degrees != 0) camera.vfov = from.vfov_degrees * kRadians;
  if (from.view_height != 0) camera.view_height = from.view_height;
  const size_t keys = std::max<size_t>(from.key_count, 1);
  const double* const rows = &needed(from.to_world, "to_world");
  if (keys > 1) needed(from.key_times, "key_times");
  for (size_t k = 0; k < keys; ++k) {
    Matrix matrix;
    for (size_t r = 0; r < 4; ++r)
      for (size_t c = 0; c < 4; ++c) matrix[c][r] = rows[16 * k + 4 * r + c];
    camera.keys.push_back(camera_key(from.key_times != nullptr ? from.key_times[k] : 0, matrix));
  }
  return camera;
}

Light light_of(const kairos_light& given) {
  const kairos_light from = taken(&given, "light");
  const Vec3f position = vector_of(from.position), direction = vector_of(from.direction),
              brightness = vector_of(from.brightness);
  switch (from.kind) {
    case KAIROS_POINT_LIGHT:
      return PointLight{position, brightness};
    case KAIROS_SPOT_LIGHT:
      return SpotLight{position, direction, brightness, from.cos_inner, from.cos_outer};
    case KAIROS_DIRECTIONAL_LIGHT:
      return DirectionalLight{direction, brightness};
    case KAIROS_CONSTANT_LIGHT:
      return ConstantLight{brightness};
    default:
      refuse("light", "has a kind that is none of KAIROS_POINT_LIGHT and so on");
  }
}

}  // namespace

}  // namespace kairos::c_interface

using namespace kairos::c_interface;

extern "C" {

kairos_status kairos_material_init(kairos_material* material, uint32_t struct_size) {
  return guarded([&] {
    needed(material, "material");
    const kairos::Material defaults;
    kairos_material out{};
    out.struct_size = struct_size;
    for (int i = 0; i < 3; ++i) out.base_color[i] = defaults.base_color[i];
    out.metallic = defaults.metallic;
    out.roughness = defaults.roughness;
    out.transmission = defaults.transmission;
    out.ior = defaults.ior;
    out.alpha = defaults.alpha;
    out.alpha_cutoff = defaults.alpha_cutoff;
    if (struct_size < sizeof(out.struct_size) || struct_size > sizeof(out))
      refuse("struct_size", "is not the sizeof of a kairos_material that this library knows");
    std::memcpy(material, &out, struct_size);
  });
}

kairos_status kairos_make_scene(const kairos_scene_description* description, kairos_scene** out) {
  return guarded([&] {
    needed(out, "out");
    const kairos_scene_description from = taken(&needed(description, "description"), "description");
    kairos::SceneDescription scene;
    for_each(from.meshes, from.mesh_count, "meshes",
             [&](const kairos_mesh& mesh) { scene.meshes.push_back(description_of(mesh)); });
    for_each(from.materials, from.material_count, "materials",
             [&](const kairos_material& material) { scene.materials.push_back(material_of(material)); });
    for_each(from.cameras, from.camera_count, "cameras",
             [&](const kairos_camera& camera) { scene.cameras.push_back(camera_of(camera)); });
    for_each(from.lights, from.light_count, "lights",
             [&](const kairos_light& light) { scene.lights.push_back(light_of(light)); });
    scene.background = vector_of(from.background);
    if (from.fps != 0) scene.fps = from.fps;
    auto made = std::make_unique<kairos_scene>();
    made->scene = kairos::make_scene(std::move(scene));
    *out = made.release();
  });
}

}  // extern "C"
