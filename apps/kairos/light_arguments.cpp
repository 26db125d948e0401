#include "light_arguments.h"

namespace kairos::cli {

namespace {

BackgroundChoice parse_background(std::string_view text) {
  if (text == "environment") return {};
  if (text == "transparent") return {true, {}};
  const auto parts = split("--background", text, ',', 3, "environment, transparent or R,G,B");
  Vec3f colour;
  constexpr double kBrightest = 1e30;  // far above any light, far below float's overflow
  for (size_t i = 0; i < 3; ++i) {
    const double value = parse_real("--background", parts[i]);
    if (!(value >= 0 && value <= kBrightest))
      throw CLI::ValidationError("--background", fmt::format("'{}' is no colour: no part may be negative", text));
    colour[static_cast<int>(i)] = static_cast<float>(value);
  }
  return {false, colour};
}

}  // namespace

void BackgroundChoice::apply(Shot& shot) const {
  if (transparent) shot.backdrop = Vec3f{};
  if (colour) shot.backdrop = colour;
}

void LightArguments::apply(const CLI::App& app, RenderParams& params, ShotOptions& shot) const {
  const bool lit = is_lit(params.shading);
  // Other shadings show an environment that is asked for, and need no light.
  shot.lights = lit || app.count("--lights") > 0 ? lights : LightChoice::file;
  shot.environment = environment;
  if (!environment && (rotation_degrees || strength))
    throw CLI::ValidationError(rotation_degrees ? "--environment-rotation" : "--environment-strength",
                               "turns or scales the picture of --environment, which is not given");
  if (shot.environment) {
    shot.environment->rotation_degrees = rotation_degrees.value_or(0);
    shot.environment->strength = strength.value_or(1);
  }
  params.alpha = background.transparent;
}

void add_light_options(CLI::App& app, LightArguments& out) {
  app.add_option_function<std::string>(
         "--lights", [&out](const std::string& text) { out.lights = parse_choice<LightChoice>("--lights", text); },
         "Lights: those of the file, a studio's, or none; what emits, glows in any case (default: auto, those of the "
         "file, or a studio's where it brings none)")
      ->type_name("auto|file|studio|none");
  app.add_option_function<std::string>(
         "--environment", [&out](const std::string& text) { out.environment = EnvironmentPicture{text}; },
         "A picture of all that is far away, by latitude and longitude, in place of the scene's or the studio's")
      ->type_name("FILE.hdr|FILE.exr");
  add_real(app, "--environment-rotation", "Degrees by which it is turned, counter-clockwise seen from above [0]", "D",
           [&out](double v) { out.rotation_degrees = v; });
  add_real(app, "--environment-strength", "What it is multiplied by [1]", "S", [&out](double v) {
    constexpr double kMost = 1e30;
    if (!(v >= 0 && v <= kMost)) throw CLI::ValidationError("--environment-strength", "must be 0 to 1e30");
    out.strength = v;
  });
  app.add_option_function<std::string>(
         "--background", [&out](const std::string& text) { out.background = parse_background(text); },
         "What is seen beyond everything: the environment (default), a linear colour, or nothing: then the picture has "
         "an alpha channel")
      ->type_name("environment|R,G,B|transparent");
}

}  // namespace kairos::cli
