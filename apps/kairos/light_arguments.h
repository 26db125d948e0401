// What lights a scene and what is seen beyond it.
#pragma once

#include <optional>
#include <string>

#include <kairos/render.h>
#include <kairos/scene.h>

#include "arguments.h"

namespace kairos::cli {

struct BackgroundChoice {
  bool transparent = false;
  std::optional<Vec3f> colour;  ///< unset, and not transparent: the scene's own and its environment

  void apply(Shot& shot) const;
};

struct LightArguments {
  LightChoice lights = LightChoice::automatic;
  std::optional<EnvironmentPicture> environment;
  std::optional<double> rotation_degrees, strength;
  BackgroundChoice background;

  /// Throws CLI::ValidationError for options that need others.
  void apply(const CLI::App& app, RenderParams& params, ShotOptions& shot) const;
};
void add_light_options(CLI::App& app, LightArguments& out);

}  // namespace kairos::cli
