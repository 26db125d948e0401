#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/make_scene.h>

#include "camera/film_plane.h"
#include "image/pixels.h"
#include "scene/scene.h"
#include "scene_io/keyframes.h"
#include "scene_io/mesh_data.h"
#include "scene_io/turned_triangles.h"

namespace kairos {

namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& why) {
  throw Error(ErrorCode::bad_input, place, why);
}

std::string place_of(const char* kind, size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {} '{}'", kind, index, name);
}

void check_times(const std::vector<double>& times, size_t keys, const std::string& place) {
  if (times.size() != keys)
    refuse(place, fmt::format("has {} keys and {} times; give each key one", keys, times.size()));
  for (size_t k = 0; k < keys; ++k) {
    if (!std::isfinite(times[k])) refuse(place, fmt::format("key {} has a time that is not finite", k));
    if (k > 0 && !(times[k - 1] < times[k]))
      refuse(place, fmt::format("times must ascend: {} is followed by {}", times[k - 1], times[k]));
  }
}

void check_vertices(const MeshDescription& mesh, const std::string& place) {
  if (mesh.positions.empty()) refuse(place, "has no key; give the positions of its vertices at one time at least");
  const size_t vertices = mesh.positions.front().size();
  if (vertices > kMaxIndices) refuse(place, fmt::format("has more than {} vertices", kMaxIndices));
  const auto check_key = [&](const char* what, size_t k, const std::vector<Vec3f>& values) {
    if (values.size() != vertices)
      refuse(place, fmt::format("key {} has {} {}, and the first key {} vertices", k, values.size(), what, vertices));
    const auto bad = std::find_if(values.begin(), values.end(), [](Vec3f v) { return !is_finite(v); });
    if (bad != values.end())
      refuse(place, fmt::format("key {}: number {} of its {} is not finite", k, bad - values.begin(), what));
  };
  for (size_t k = 0; k < mesh.positions.size(); ++k) check_key("positions", k, mesh.positions[k]);
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
    refuse(place, fmt::format("has normals at {} of its {} keys; give them at all or none", mesh.normals.size(),
                              mesh.positions.size()));
  for (size_t k = 0; k < mesh.normals.size(); ++k) check_key("normals", k, mesh.normals[k]);
  const auto check_uvs = [&](const std::vector<Vec2f>& uvs) {
    if (!uvs.empty() && uvs.size() != vertices)
      refuse(place, fmt::format("has {} texture coordinates for {} vertices", uvs.size(), vertices));
  };
  check_uvs(mesh.uvs);
  for (const std::vector<Vec2f>& set : mesh.more_uvs) check_uvs(set);
  if (!mesh.colors.empty() && mesh.colors.size() != vertices)
    refuse(place, fmt::format("has {} colours for {} vertices", mesh.colors.size(), vertices));
  for (size_t v = 0; v < mesh.colors.size(); ++v)
    for (const float part : {mesh.colors[v].x, mesh.colors[v].y, mesh.colors[v].z, mesh.colors[v].w})
      if (!(part >= 0) || !std::isfinite(part))
        refuse(place, fmt::format("the colour of vertex {} has a part that is negative or not finite", v));
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t v : mesh.triangles[i])
      if (v >= vertices) refuse(place, fmt::format("triangle {} has vertex {} of {}", i, v, vertices));
}

/// Unit normals as readers of files make them.
void normalize_all(std::vector<std::vector<Vec3f>>& normals, const std::string& place) {
  for (size_t k = 0; k < normals.size(); ++k)
    for (size_t v = 0; v < normals[k].size(); ++v) {
      Vec3f& n = normals[k][v];
      n = to_float(normalize(to_double(n)));
      if (n == Vec3f{}) refuse(place, fmt::format("key {}: the normal of vertex {} is zero", k, v));
    }
}

TransformKeys transform_of(const std::vector<PlacementKey>& placement, const std::string& place) {
  TransformKeys keys;
  for (size_t k = 0; k < placement.size(); ++k) {
    const Matrix& m = placement[k].matrix;
    for (size_t c = 0; c < 4; ++c)
      for (size_t r = 0; r < 4; ++r)
        if (!std::isfinite(m[c][r])) refuse(place, fmt::format("key {} has a matrix that is not finite", k));
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
      refuse(place, fmt::format("key {} has a matrix whose last row is not 0 0 0 1; matrices are m[column][row]", k));
    keys.times.push_back(placement[k].time);
    keys.matrices.push_back({m});
  }
  check_times(keys.times, placement.size(), place);
  return keys;
}

SceneCamera camera_of(const CameraDescription& camera, const std::string& place) {
  check_lens(camera, place);
  if (camera.keys.empty()) refuse(place, "has no key; say from where it looks where at one time at least");
  std::vector<double> times;
  std::vector<LookAtKey> keys;
  for (const CameraKey& key : camera.keys) {
    if (!is_finite(key.eye) || !is_finite(key.target) || !is_finite(key.up))
      refuse(place, fmt::format("key {} is not finite", keys.size()));
    times.push_back(key.time);
    keys.push_back({key.time, key.eye, key.target, key.up});
  }
  check_times(times, keys.size(), place);
  SceneCamera result;
  static_cast<Lens&>(result) = camera;
  result.name = camera.name;
  result.motion = std::make_shared<LookAtMotion>(std::move(keys), place);
  return result;
}

void check_colour(Vec3f colour, const char* what, const std::string& place) {
  if (!is_finite(colour) || colour.x < 0 || colour.y < 0 || colour.z < 0)
    refuse(place, fmt::format("the {} ({}, {}, {}) is not a colour: no part may be negative or not finite", what,
                              colour.x, colour.y, colour.z));
}

void check_material(const Material& m, const std::string& place) {
  check_colour(m.base_color, "base colour", place);
  check_colour(m.emission, "emission", place);
  const auto check = [&](const char* what, float value, float least, float most) {
    if (!(value >= least && value <= most))
      refuse(place, fmt::format("the {} {} is not between {} and {}", what, value, least, most));
  };
  constexpr float kHighestIor = 100;
  check("metallic", m.metallic, 0, 1);
  check("roughness", m.roughness, 0, 1);
  check_colour(m.specular_color, "specular colour", place);
  check("specular", m.specular, 0, 1);
  check("clearcoat", m.clearcoat, 0, 1);
  check("clearcoat roughness", m.clearcoat_roughness, 0, 1);
  check("transmission", m.transmission, 0, 1);
  check("ior", m.ior, 1, kHighestIor);
  check("alpha", m.alpha, 0, 1);
  check("alpha cut-off", m.alpha_cutoff, 0, 1);
  if (!std::isfinite(m.normal_scale)) refuse(place, "the scale of its normal picture is not finite");
  for (const TextureRef* texture :
       {&m.base_color_texture, &m.emission_texture, &m.metallic_roughness_texture, &m.alpha_texture, &m.normal_texture})
    if (!is_finite(texture->placement[0]) || !is_finite(texture->placement[1]))
      refuse(place, "the placement of one of its pictures is not finite");
}

/// Checks a light, and gives its directions unit length.
struct LightChecker {
  const std::string& place;

  Vec3f direction(Vec3f d) const {
    const Vec3d unit = normalize(to_double(d));
    if (unit == Vec3d{}) refuse(place, "its direction is zero or not finite");
    return to_float(unit);
  }
  void position(Vec3f p) const {
    if (!is_finite(p)) refuse(place, "its position is not finite");
  }

  void operator()(PointLight& light) const {
    position(light.position);
    check_colour(light.intensity, "intensity", place);
  }
  void operator()(SpotLight& light) const {
    position(light.position);
    light.direction = direction(light.direction);
    check_colour(light.intensity, "intensity", place);
    if (!(light.cos_outer >= 0 && light.cos_inner >= light.cos_outer && light.cos_inner <= 1))
      refuse(place, fmt::format("the cosines {} (inner) and {} (outer) are not 0 <= outer <= inner <= 1",
                                light.cos_inner, light.cos_outer));
  }
  void operator()(DirectionalLight& light) const {
    light.direction = direction(light.direction);
    check_colour(light.irradiance, "irradiance", place);
  }
  void operator()(ConstantLight& light) const { check_colour(light.radiance, "radiance", place); }
  void operator()(EnvironmentLight& light) const {
    check_colour(light.radiance, "radiance", place);
    constexpr double kRounding = 1e-6;
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j)
        if (!(std::abs(dot(light.axes[i], light.axes[j]) - (i == j ? 1 : 0)) < kRounding))
          refuse(place, "its axes are not unit vectors at right angles");
  }
};

void check_picture(const std::string& name, const Pixels& picture) {
  const std::string place = "picture '" + name + "'";
  if (name.empty()) refuse(place, "has no name, by which a material could call it");
  if (picture.width < 1 || picture.height < 1 ||
      static_cast<uint64_t>(picture.width) * static_cast<uint64_t>(picture.height) > kMaxPicturePixels)
    refuse(place, fmt::format("has {}x{} pixels, and not 1 to {}", picture.width, picture.height, kMaxPicturePixels));
  const size_t values = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height) * 4;
  const size_t given[] = {picture.codes.size(), picture.values.size(), picture.wide_codes.size()};
  if (std::count(std::begin(given), std::end(given), values) != 1 ||
      std::count(std::begin(given), std::end(given), size_t{0}) != 2)
    refuse(place, fmt::format("has {} codes, {} values and {} wide codes; give {} of one of them: four per pixel",
                              given[0], given[1], given[2], values));
  if (!std::all_of(picture.values.begin(), picture.values.end(), [](float v) { return std::isfinite(v); }))
    refuse(place, "has a value that is not finite");
}

class SceneMaker {
 public:
  explicit SceneMaker(SceneDescription description) : from_(std::move(description)) {}

  Scene make() {
    make_materials();
    for (auto& [name, picture] : from_.pictures) check_picture(name, picture);
    scene_.pictures = std::move(from_.pictures);
    for (size_t i = 0; i < from_.cameras.size(); ++i)
      scene_.cameras.push_back(camera_of(from_.cameras[i], place_of("camera", i, from_.cameras[i].name)));
    for (size_t i = 0; i < from_.lights.size(); ++i)
      std::visit(LightChecker{place_of("light", i, "")}, from_.lights[i]);
    scene_.lights = std::move(from_.lights);
    scene_.brings_lights = !scene_.lights.empty();
    check_colour(from_.background, "background", "scene");
    scene_.background = from_.background;
    make_meshes();
    place_instances();
    set_shutter();
    return std::move(scene_);
  }

 private:
  void make_materials() {
    for (size_t i = 0; i < from_.materials.size(); ++i)
      check_material(from_.materials[i], place_of("material", i, from_.materials[i].name));
    scene_.materials = std::move(from_.materials);
    if (scene_.materials.empty()) scene_.materials.emplace_back();
  }

  void check_material_index(uint32_t material, const std::string& place) const {
    if (material >= scene_.materials.size())
      refuse(place, fmt::format("has material {}; the scene has {}", material, scene_.materials.size()));
  }

  void make_meshes() {
    for (size_t i = 0; i < from_.meshes.size(); ++i) {
      MeshDescription& mesh = from_.meshes[i];
      const std::string place = place_of("mesh", i, mesh.name);
      check_vertices(mesh, place);
      check_material_index(mesh.material, place);
      if (mesh.times.empty() && mesh.positions.size() == 1) mesh.times = {0};
      check_times(mesh.times, mesh.positions.size(), place);
      normalize_all(mesh.normals, place);
      vertices_.push_back(std::make_shared<const VertexKeys>(
          VertexKeys{std::move(mesh.times), std::move(mesh.positions), std::move(mesh.normals)}));
    }
  }

  /// What all instances of a mesh have in common, of which it is made when it is first asked for.
  const SceneMesh& shared_of(uint32_t index) {
    const auto [place, is_new] = shared_.try_emplace(index);
    SceneMesh& shared = place->second;
    if (!is_new) return shared;
    MeshDescription& mesh = from_.meshes[index];
    shared.triangles = std::move(mesh.triangles);
    shared.uvs = std::move(mesh.uvs);
    shared.more_uvs = std::move(mesh.more_uvs);
    shared.colors = std::move(mesh.colors);
    return shared;
  }

  void place_instances() {
    std::vector<InstanceDescription>& instances = from_.instances;
    if (instances.empty())
      for (uint32_t i = 0; i < from_.meshes.size(); ++i) instances.push_back({i, {}, {}, {}});
    for (size_t i = 0; i < instances.size(); ++i) {
      const InstanceDescription& instance = instances[i];
      const std::string place = place_of("instance", i, instance.name);
      if (instance.mesh >= from_.meshes.size())
        refuse(place, fmt::format("is of mesh {}; the scene has {}", instance.mesh, from_.meshes.size()));
      const MeshDescription& mesh = from_.meshes[instance.mesh];
      const auto motion =
          std::make_shared<KeyframeMotion>(vertices_[instance.mesh], transform_of(instance.placement, place));
      SceneMesh placed;
      placed.name = instance.name.empty() ? mesh.name : instance.name;
      const SceneMesh& shared = shared_of(instance.mesh);
      placed.triangles = motion->mirrors() ? turned_.of(shared.triangles) : shared.triangles;
      placed.uvs = shared.uvs;
      placed.more_uvs = shared.more_uvs;
      placed.colors = shared.colors;
      placed.material = instance.material.value_or(mesh.material);
      check_material_index(placed.material, place);
      placed.motion = motion;
      scene_.meshes.push_back(std::move(placed));
    }
  }

  void set_shutter() {
    const auto [open, close] = from_.shutter;
    if (!std::isfinite(open) || !std::isfinite(close) || !(open <= close))
      refuse("shutter", fmt::format("opens at {} and closes at {}; give two times that do not descend", open, close));
    scene_.shutter = from_.shutter;
    if (!(from_.fps > 0) || !std::isfinite(from_.fps))
      refuse("scene", fmt::format("{} frames per unit of time make no sense", from_.fps));
    scene_.fps = from_.fps;
    scene_.image_size = from_.image_size;
  }

  SceneDescription from_;
  Scene scene_;
  std::vector<std::shared_ptr<const VertexKeys>> vertices_;  // [mesh]
  std::map<uint32_t, SceneMesh> shared_;                     // by mesh
  TurnedTriangles turned_;
};

}  // namespace

std::shared_ptr<const Scene> make_scene(SceneDescription description) {
  return std::make_shared<const Scene>(SceneMaker(std::move(description)).make());
}

}  // namespace kairos
