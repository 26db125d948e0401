#include "scene_io/pbrt_light.h"

#include <algorithm>
#include <cmath>

#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

constexpr Vec3d kWhite{1, 1, 1};
constexpr double kLargest = 1e30;  // far above any light, far below float's overflow

Vec3f limited(Vec3d v) {
  for (int axis = 0; axis < 3; ++axis) v[axis] = std::isnan(v[axis]) ? 0 : std::clamp(v[axis], -kLargest, kLargest);
  return to_float(v);
}

Vec3f power(const Parameters& parameters, const char* name, SpectrumContext& context) {
  if (parameters.find("power") || parameters.find("illuminance"))
    context.warnings.add(parameters.place(), "a light's 'power' or 'illuminance' is left out: its colour counts");
  return limited(spectrum_color(parameters, name, kWhite, context) *
                 spectrum_color(parameters, "scale", kWhite, context));
}

}  // namespace

std::optional<LightSource> read_light(const std::string& kind, const Parameters& parameters,
                                      const TransformPair& world_from_light, SpectrumContext& context) {
  const Mat4& matrix = world_from_light.start;
  if (world_from_light.start != world_from_light.end)
    context.warnings.add(parameters.place(), "a light that moves stays where it starts");
  for (const char* passed_over : {"samples", "nsamples"}) parameters.find(passed_over);
  std::optional<LightSource> source;
  if (kind == "point" || kind == "spot" || kind == "goniometric" || kind == "projection") {
    for (const char* shape : {"to", "coneangle", "conedeltaangle", "fov", "mapname", "filename"})
      parameters.find(shape);
    if (kind != "point")
      context.warnings.add(parameters.place(), "lights of kind '" + kind + "' shine in all directions");
    const Vec3d position = transform_point(matrix, parameters.vec3("from", {}));
    source = {PointLight{limited(position), power(parameters, "I", context)}, false};
  } else if (kind == "distant") {
    const Vec3d way = parameters.vec3("to", {0, 0, 1}) - parameters.vec3("from", {});
    const Vec3d direction = normalize(transform_vector(matrix, way));
    if (length(direction) == 0) fail(parameters.place(), "a distant light has no direction");
    source = {DirectionalLight{to_float(direction), power(parameters, "L", context)}, false};
  } else if (kind == "infinite" || kind == "exinfinite") {
    const bool image = parameters.find("mapname") || parameters.find("filename");
    parameters.find("portal");
    if (image)
      context.warnings.add(parameters.place(), "the picture of an infinite light is left out: its light is even");
    source = {ConstantLight{power(parameters, "L", context)}, !image};
  } else {
    context.warnings.add(parameters.place(), "lights of kind '" + printable(kind) + "' are left out");
    return std::nullopt;
  }
  parameters.warn_unused("light '" + kind + "'", context.warnings);
  return source;
}

Vec3f read_area_light(const std::string& kind, const Parameters& parameters, SpectrumContext& context) {
  if (kind != "diffuse" && kind != "area")
    context.warnings.add(parameters.place(), "area lights of kind '" + printable(kind) + "' are taken as 'diffuse'");
  for (const char* passed_over : {"samples", "nsamples", "twosided"}) parameters.find(passed_over);
  if (parameters.find("filename"))
    context.warnings.add(parameters.place(), "the picture of an area light is left out: its light is even");
  const Vec3f radiance = power(parameters, "L", context);
  parameters.warn_unused("area light", context.warnings);
  return radiance;
}

}  // namespace kairos::pbrt
