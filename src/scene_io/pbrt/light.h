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
  Vec3f background;  ///< what of it is seen directly
};

/// What a mirror across the plane x = 0 makes of a light.
void mirror_in_x(Light& light);

/// Reads a LightSource statement. Nothing, with a warning, for a kind that is not known; a warning where a light's
/// shape or picture is lost.
std::optional<LightSource> read_light(const std::string& kind, const Parameters& parameters,
                                      const TransformPair& world_from_light, SpectrumContext& context);

/// The radiance of an AreaLightSource statement.
Vec3f read_area_light(const std::string& kind, const Parameters& parameters, SpectrumContext& context);

}  // namespace kairos::pbrt
