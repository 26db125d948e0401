// Lights of pbrt scene files as ours.
#pragma once

#include <optional>
#include <string>

#include <kairos/scene.h>

#include "scene_io/pbrt/spectrum.h"
#include "scene_io/pbrt/transform.h"

namespace kairos::pbrt {

struct LightSource {
  Light light;
  Vec3f background;    ///< what of it is seen directly
  bool moves = false;  ///< the light is in the statement's own space, not in the world
};

/// What a mirror across the plane x = 0 makes of a light.
void mirror_in_x(Light& light);

/// Reads a LightSource statement. Nothing, with a warning, for a kind that is not known; a warning where a light's
/// shape or picture is lost, or its motion: an environment's, or one through transforms that project.
std::optional<LightSource> read_light(const std::string& kind, const Parameters& parameters,
                                      const TransformPair& world_from_light, SpectrumContext& context);

/// Multiplies what a light shines.
void scale_light(Light& light, float factor);

/// A colour within what float can hold, with room for products; 0 for NaN.
Vec3f limited(Vec3d color);

/// A light that is the surface of a shape.
struct AreaLight {
  Vec3f radiance;
  bool two_sided = false;  ///< otherwise only its front shines
  double power = 0;        ///< pbrt-v4: of each shape, in place of the radiance's; 0: not given
};

/// Reads an AreaLightSource statement.
AreaLight read_area_light(const std::string& kind, const Parameters& parameters, SpectrumContext& context);

/// Its radiance where its power is spread over an area.
Vec3f light_of_power(const AreaLight& light, double area);

}  // namespace kairos::pbrt
