#include "scene_io/native/parts.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "camera/film_plane.h"
#include "scene_io/load.h"
#include "scene_io/text_numbers.h"

namespace kairos {

namespace {

void read_if(const JsonNode& node, const char* field, float& out, double low, double high) {
  if (const auto value = node.find(field)) out = static_cast<float>(value->number(low, high));
}

void read_if(const JsonNode& node, const char* field, Vec3f& out) {
  if (const auto value = node.find(field)) out = value->color();
}

void read_if(const JsonNode& node, const char* field, bool& out) {
  if (const auto value = node.find(field)) out = value->boolean();
}

/// Unless the mode is given, a cut-off makes a mask, and an alpha of its own something blended.
void read_alpha(const JsonNode& node, Material& material) {
  using Mode = Material::AlphaMode;
  const auto cutoff = node.find("alpha_cutoff");
  read_if(node, "alpha", material.alpha, 0, 1);
  read_if(node, "alpha_cutoff", material.alpha_cutoff, 0, 1);
  if (cutoff)
    material.alpha_mode = Mode::mask;
  else if (node.find("alpha") || node.find("alpha_texture"))
    material.alpha_mode = Mode::blend;
  const auto mode = node.find("alpha_mode");
  if (!mode) return;
  const std::string name = mode->string();
  if (name != "opaque" && name != "mask" && name != "blend")
    mode->fail("unknown alpha mode '" + printable(name) + "'; expected opaque, mask or blend");
  material.alpha_mode = name == "opaque" ? Mode::opaque : name == "mask" ? Mode::mask : Mode::blend;
  if (cutoff && material.alpha_mode != Mode::mask) cutoff->fail("only the alpha mode 'mask' has a cut-off");
}

TextureWrap read_wrap(const JsonNode& node) {
  const std::string name = node.string();
  if (name != "repeat" && name != "clamp" && name != "mirror")
    node.fail("unknown wrap '" + printable(name) + "'; expected repeat, clamp or mirror");
  return name == "repeat" ? TextureWrap::repeat : name == "clamp" ? TextureWrap::clamp : TextureWrap::mirror;
}

/// A picture's file, or an object that also says how it lies.
TextureRef read_texture_ref(const JsonNode& node, const FindPicture& find_picture) {
  TextureRef texture;
  if (!node.is_object()) {
    texture.picture = find_picture(node);
    return texture;
  }
  constexpr int kMostUvSets = 8;
  constexpr double kMost = 1e6;
  node.expect_fields({"file", "uv_set", "placement", "wrap", "nearest"});
  texture.picture = find_picture(node.at("file"));
  if (const auto set = node.find("uv_set")) texture.uv_set = static_cast<uint32_t>(set->integer(0, kMostUvSets - 1));
  if (const auto placement = node.find("placement")) {
    const std::vector<JsonNode> numbers = placement->items(6);
    for (size_t row = 0; row < 2; ++row)
      for (size_t column = 0; column < 3; ++column)
        texture.placement[row][static_cast<int>(column)] =
            static_cast<float>(numbers[3 * row + column].number(-kMost, kMost));
  }
  if (const auto wrap = node.find("wrap")) {
    const std::vector<JsonNode> both = wrap->items(2);
    texture.wrap = {read_wrap(both[0]), read_wrap(both[1])};
  }
  if (const auto nearest = node.find("nearest")) texture.nearest = nearest->boolean();
  return texture;
}

constexpr double kSteepest = 1000;  // of normals in a picture

}  // namespace

Material read_material(const std::string& name, const JsonNode& node, const FindPicture& find_picture) {
  node.expect_fields({"base_color",
                      "base_color_texture",
                      "emission",
                      "emission_texture",
                      "metallic",
                      "roughness",
                      "metallic_roughness_texture",
                      "transmission",
                      "ior",
                      "alpha_mode",
                      "alpha",
                      "alpha_texture",
                      "alpha_cutoff",
                      "double_sided",
                      "normal_texture",
                      "normal_scale",
                      "specular",
                      "specular_color",
                      "clearcoat",
                      "clearcoat_roughness",
                      "unlit",
                      "one_sided_emission",
                      "lamp"});
  Material material;
  material.name = name;
  read_if(node, "base_color", material.base_color);
  read_if(node, "emission", material.emission);
  read_if(node, "metallic", material.metallic, 0, 1);
  read_if(node, "roughness", material.roughness, 0, 1);
  read_if(node, "transmission", material.transmission, 0, 1);
  read_if(node, "ior", material.ior, 1, 100);
  read_if(node, "specular", material.specular, 0, 1);
  read_if(node, "specular_color", material.specular_color);
  read_if(node, "clearcoat", material.clearcoat, 0, 1);
  read_if(node, "clearcoat_roughness", material.clearcoat_roughness, 0, 1);
  read_if(node, "normal_scale", material.normal_scale, -kSteepest, kSteepest);
  read_if(node, "unlit", material.unlit);
  read_if(node, "one_sided_emission", material.one_sided_emission);
  read_if(node, "lamp", material.lamp);
  const auto read_texture = [&](const char* field, TextureRef& out) {
    if (const auto texture = node.find(field)) out = read_texture_ref(*texture, find_picture);
  };
  read_texture("base_color_texture", material.base_color_texture);
  read_texture("emission_texture", material.emission_texture);
  read_texture("metallic_roughness_texture", material.metallic_roughness_texture);
  read_alpha(node, material);
  read_if(node, "double_sided", material.double_sided);
  read_texture("alpha_texture", material.alpha_texture);
  read_texture("normal_texture", material.normal_texture);
  return material;
}

/// The picture turns counter-clockwise, seen from above.
EnvironmentLight read_environment(const JsonNode& node, const FindPicture& find_picture) {
  node.expect_fields({"type", "texture", "intensity", "rotation_degrees"});
  EnvironmentLight light;
  light.texture = find_picture(node.at("texture"));
  constexpr double kBrightest = 1e30;  // far above any light, far below float's overflow
  if (const auto intensity = node.find("intensity"))
    light.radiance = light.radiance * static_cast<float>(intensity->number(0, kBrightest));
  if (const auto rotation = node.find("rotation_degrees")) {
    constexpr double kMostDegrees = 1e6;
    const double angle = rotation->number(-kMostDegrees, kMostDegrees) * std::numbers::pi / 180;
    light.axes = {Vec3d{std::cos(angle), 0, -std::sin(angle)}, Vec3d{0, 1, 0},
                  Vec3d{std::sin(angle), 0, std::cos(angle)}};
  }
  return light;
}

Light read_light(const JsonNode& node, const FindPicture& find_picture) {
  if (!node.is_object()) node.fail("expected an object");
  const std::string type = node.at("type").string();
  if (type == "point") {
    node.expect_fields({"type", "position", "intensity"});
    return PointLight{to_float(node.at("position").vec3()), node.at("intensity").color()};
  }
  if (type == "spot") {
    node.expect_fields({"type", "position", "direction", "intensity", "inner_degrees", "outer_degrees"});
    const Vec3d direction = normalize(node.at("direction").vec3());
    if (direction == Vec3d{}) node.at("direction").fail("a direction cannot be zero");
    const double outer = node.at("outer_degrees").number(0, 90);
    const auto inner = node.find("inner_degrees");
    const auto cosine = [](double degrees) { return static_cast<float>(std::cos(degrees * std::numbers::pi / 180)); };
    return SpotLight{to_float(node.at("position").vec3()), to_float(direction), node.at("intensity").color(),
                     cosine(inner ? inner->number(0, outer) : 0), cosine(outer)};
  }
  if (type == "directional") {
    node.expect_fields({"type", "direction", "irradiance"});
    const Vec3d direction = normalize(node.at("direction").vec3());
    if (direction == Vec3d{}) node.at("direction").fail("a direction cannot be zero");
    return DirectionalLight{to_float(direction), node.at("irradiance").color()};
  }
  if (type == "constant") {
    node.expect_fields({"type", "radiance"});
    return ConstantLight{node.at("radiance").color()};
  }
  if (type == "environment") return read_environment(node, find_picture);
  node.at("type").fail("unknown light '" + printable(type) +
                       "'; expected point, spot, directional, constant or environment");
}

std::vector<double> read_key_times(const std::vector<JsonNode>& keys) {
  std::vector<double> times;
  for (const JsonNode& key : keys)
    if (const auto time = key.find("time")) times.push_back(time->time());
  if (times.empty()) return even_times(keys.size());
  for (const JsonNode& key : keys)
    if (times.size() != keys.size() && !key.find("time"))
      key.fail("the field 'time' is missing; give it for all keys or for none");
  return times;
}

void expect_ascending(const std::vector<double>& times, const JsonNode& node) {
  for (size_t k = 1; k < times.size(); ++k)
    if (!(times[k - 1] < times[k]))
      node.fail(fmt::format("times must ascend: {} is followed by {}", times[k - 1], times[k]));
}

SceneCamera read_camera(const JsonNode& node) {
  node.expect_fields({"vfov_degrees", "pixel_aspect", "shift", "projection_matrix", "keys"});
  SceneCamera camera;
  camera.name = "camera";
  if (const auto vfov = node.find("vfov_degrees")) {
    const double degrees = vfov->number();
    if (!(degrees >= 0.001 && degrees <= 179.9)) vfov->fail(fmt::format("{} is not between 0.001 and 179.9", degrees));
    camera.vfov = degrees * std::numbers::pi / 180;
  }
  if (const auto aspect = node.find("pixel_aspect")) camera.pixel_aspect = aspect->number();
  if (const auto shift = node.find("shift")) {
    const std::vector<JsonNode> parts = shift->items(2);
    camera.shift = {parts[0].number(), parts[1].number()};
  }
  if (const auto matrix = node.find("projection_matrix")) {
    for (const char* other : {"vfov_degrees", "pixel_aspect", "shift"})
      if (const auto given = node.find(other)) given->fail("says what 'projection_matrix' says already; leave one out");
    camera.matrix.emplace();
    const std::vector<JsonNode> entries = matrix->items(16);
    for (size_t i = 0; i < 16; ++i) (*camera.matrix)[i / 4][i % 4] = entries[i].number();
  }
  check_lens(camera, node.place());
  const std::vector<JsonNode> keys = node.at("keys").items();
  if (keys.empty()) node.at("keys").fail("a camera needs at least one key");
  for (const JsonNode& key : keys) key.expect_fields({"time", "eye", "target", "up"});
  const std::vector<double> times = read_key_times(keys);
  expect_ascending(times, node.at("keys"));
  std::vector<LookAtKey> look_at_keys;
  for (size_t k = 0; k < keys.size(); ++k) {
    const auto up = keys[k].find("up");
    look_at_keys.push_back(
        {times[k], keys[k].at("eye").vec3(), keys[k].at("target").vec3(), up ? up->vec3() : Vec3d{0, 1, 0}});
  }
  camera.motion = std::make_shared<LookAtMotion>(std::move(look_at_keys), node.at("keys").place());
  return camera;
}

TransformKeys read_transform(const JsonNode& node) {
  const std::vector<JsonNode> keys = node.is_object() ? std::vector<JsonNode>{node} : node.items();
  if (keys.empty()) node.fail("a transform needs at least one matrix");
  TransformKeys transform;
  for (const JsonNode& key : keys) {
    key.expect_fields({"time", "matrix"});
    const JsonNode numbers = key.at("matrix");
    const std::vector<JsonNode> entries = numbers.items(16);
    constexpr double kLimit = std::numeric_limits<float>::max();
    Mat4 matrix;
    for (size_t i = 0; i < 16; ++i) matrix.m[i / 4][i % 4] = entries[i].number(-kLimit, kLimit);
    for (size_t c = 0; c < 4; ++c)
      if (matrix.m[c][3] != (c == 3 ? 1 : 0))
        numbers.fail("its last row is not 0 0 0 1; give 16 numbers, column after column");
    transform.matrices.push_back(matrix);
  }
  transform.times = read_key_times(keys);
  expect_ascending(transform.times, node);
  return transform;
}

}  // namespace kairos
