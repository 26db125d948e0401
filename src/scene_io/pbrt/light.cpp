#include "scene_io/pbrt/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

constexpr double kLargest = 1e30;  // far above any light, far below float's overflow

Vec3d color_of(const Parameters& parameters, const char* name, SpectrumContext& context) {
  return light_color(parameters, name, kWhite, context) * spectrum_color(parameters, "scale", kWhite, context);
}

/// A light's colour so bright that its `measure` ("power" or "illuminance", of pbrt-v4) is what the statement asks for,
/// where it does. of_white: what the measure is for a light of colour (1, 1, 1).
Vec3f measured(const Parameters& parameters, const char* name, const char* measure, double of_white,
               SpectrumContext& context) {
  const Vec3d color = color_of(parameters, name, context);
  const double asked = parameters.number(measure, -1);
  return limited(asked > 0 ? color * (asked / of_white) : color);
}

/// The axes of a light's own space in the world, as near to a turn (and perhaps a reflection) as can be; nothing where
/// they are none.
std::optional<std::array<Vec3d, 3>> axes_of(const Mat4& matrix) {
  const Vec3d x = normalize(transform_vector(matrix, {1, 0, 0})), y = transform_vector(matrix, {0, 1, 0});
  const Vec3d across = normalize(y - x * dot(x, y)), z = cross(x, across);
  if (x == Vec3d{} || across == Vec3d{} || !is_finite(to_float(z))) return std::nullopt;
  return std::array{x, across, determinant3(matrix) < 0 ? -z : z};
}

/// "infinite": a colour, or a picture: v3's mapname, by latitude and longitude, or v4's filename, of equal areas.
LightSource read_infinite(const Parameters& parameters, const Mat4& matrix, SpectrumContext& context) {
  using Mapping = EnvironmentLight::Mapping;
  parameters.find("portal");
  const Vec3f radiance = measured(parameters, "L", "illuminance", std::numbers::pi, context);
  const bool v4 = parameters.find("filename") != nullptr;
  const std::string name = parameters.string(v4 ? "filename" : "mapname", "");
  if (name.empty()) return {ConstantLight{radiance}, radiance};
  if (parameters.find("illuminance"))
    context.warnings.add(parameters.place(), "the 'illuminance' of a light with a picture is as if it were even");
  const auto path = find_file(name, parameters.place(), context.folder, context.warnings, Needed::no);
  const auto axes = axes_of(matrix);
  if (!axes) fail(parameters.place(), "an infinite light's transform leaves it without directions");
  if (!path) return {ConstantLight{radiance}, {}};
  EnvironmentLight light{*path, radiance, v4 ? Mapping::equal_area : Mapping::latitude_longitude, *axes};
  // v3's left edge lies at +x, and its upper one at +z.
  if (!v4) light.axes = {-(*axes)[1], (*axes)[2], (*axes)[0]};
  return {light, {}};
}

LightSource read_spot(const Parameters& parameters, const Mat4& matrix, SpectrumContext& context) {
  constexpr double kRadians = std::numbers::pi / 180;
  const Vec3d from = parameters.vec3("from", {}), to = parameters.vec3("to", {0, 0, 1});
  const double angle = std::clamp(parameters.number("coneangle", 30), 0.0, 90.0);
  const double delta = std::clamp(parameters.number("conedeltaangle", 5), 0.0, angle);
  const Vec3d direction = normalize(transform_vector(matrix, to - from));
  if (direction == Vec3d{}) fail(parameters.place(), "a spot light has no direction");
  const double inner = std::cos((angle - delta) * kRadians), outer = std::cos(angle * kRadians);
  const double solid_angle =
      2 * std::numbers::pi * ((1 - inner) + (inner - outer) / 2);  // as pbrt-v4's falloff weighs it
  return {SpotLight{limited(project_point(matrix, from)), to_float(direction),
                    measured(parameters, "I", "power", solid_angle, context), static_cast<float>(inner),
                    static_cast<float>(outer)},
          {}};
}

}  // namespace

Vec3f limited(Vec3d color) {
  for (int axis = 0; axis < 3; ++axis)
    color[axis] = std::isnan(color[axis]) ? 0 : std::clamp(color[axis], -kLargest, kLargest);
  return to_float(color);
}

void scale_light(Light& light, float factor) {
  const auto scale = [&](Vec3f& color) { color = limited(to_double(color) * double{factor}); };
  if (auto* point = std::get_if<PointLight>(&light)) scale(point->intensity);
  if (auto* spot = std::get_if<SpotLight>(&light)) scale(spot->intensity);
  if (auto* directional = std::get_if<DirectionalLight>(&light)) scale(directional->irradiance);
  if (auto* constant = std::get_if<ConstantLight>(&light)) scale(constant->radiance);
  if (auto* environment = std::get_if<EnvironmentLight>(&light)) scale(environment->radiance);
}

void mirror_in_x(Light& light) {
  if (auto* point = std::get_if<PointLight>(&light)) point->position.x *= -1;
  if (auto* spot = std::get_if<SpotLight>(&light)) {
    spot->position.x *= -1;
    spot->direction.x *= -1;
  }
  if (auto* directional = std::get_if<DirectionalLight>(&light)) directional->direction.x *= -1;
  if (auto* environment = std::get_if<EnvironmentLight>(&light))
    for (Vec3d& axis : environment->axes) axis.x *= -1;
}

std::optional<LightSource> read_light(const std::string& kind, const Parameters& parameters,
                                      const TransformPair& world_from_light, SpectrumContext& context) {
  const bool changes = world_from_light.start != world_from_light.end;
  const bool moves = changes && kind != "infinite" && kind != "exinfinite" && !projects(world_from_light.start) &&
                     !projects(world_from_light.end);
  const Mat4 matrix = moves ? Mat4{} : world_from_light.start;
  if (changes && !moves) context.warnings.add(parameters.place(), "a light that moves stays where it starts");
  for (const char* passed_over : {"samples", "nsamples"}) parameters.find(passed_over);
  std::optional<LightSource> source;
  if (kind == "spot") {
    source = read_spot(parameters, matrix, context);
  } else if (kind == "point" || kind == "goniometric" || kind == "projection") {
    for (const char* shape : {"fov", "mapname", "filename"}) parameters.find(shape);
    if (kind != "point")
      context.warnings.add(parameters.place(), "lights of kind '" + kind + "' shine in all directions");
    const Vec3d position = project_point(matrix, parameters.vec3("from", {}));
    source = {PointLight{limited(position), measured(parameters, "I", "power", 4 * std::numbers::pi, context)}, {}};
  } else if (kind == "distant") {
    const Vec3d way = parameters.vec3("to", {0, 0, 1}) - parameters.vec3("from", {});
    const Vec3d direction = normalize(transform_vector(matrix, way));
    if (length(direction) == 0) fail(parameters.place(), "a distant light has no direction");
    source = {DirectionalLight{to_float(direction), measured(parameters, "L", "illuminance", 1, context)}, {}};
  } else if (kind == "infinite" || kind == "exinfinite") {
    source = read_infinite(parameters, matrix, context);
  } else {
    context.warnings.add(parameters.place(), "lights of kind '" + printable(kind) + "' are left out");
    return std::nullopt;
  }
  parameters.warn_unused("light '" + kind + "'", context.warnings);
  source->moves = moves;
  return source;
}

AreaLight read_area_light(const std::string& kind, const Parameters& parameters, SpectrumContext& context) {
  if (kind != "diffuse" && kind != "area")
    context.warnings.add(parameters.place(), "area lights of kind '" + printable(kind) + "' are taken as 'diffuse'");
  for (const char* passed_over : {"samples", "nsamples"}) parameters.find(passed_over);
  if (parameters.find("filename"))
    context.warnings.add(parameters.place(), "the picture of an area light is left out: its light is even");
  AreaLight light;
  light.radiance = limited(color_of(parameters, "L", context));
  light.two_sided = parameters.boolean("twosided", false);
  light.power = std::max(0.0, parameters.number("power", 0));
  parameters.warn_unused("area light", context.warnings);
  return light;
}

Vec3f light_of_power(const AreaLight& light, double area) {
  return limited(to_double(light.radiance) * (light.power / (std::numbers::pi * area * (light.two_sided ? 2 : 1))));
}

}  // namespace kairos::pbrt
