#include "scene/shot_lights.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <kairos/error.h>

#include "image/texture.h"
#include "scene/load_textures.h"
#include "scene/studio.h"

namespace kairos {

namespace {

struct Placer {
  const Mat4& matrix;

  Vec3f point(Vec3f p) const { return to_float(transform_point(matrix, to_double(p))); }
  Vec3f direction(Vec3f d) const { return to_float(normalize(transform_vector(matrix, to_double(d)))); }

  Light operator()(PointLight light) const {
    light.position = point(light.position);
    return light;
  }
  Light operator()(SpotLight light) const {
    light.position = point(light.position);
    light.direction = direction(light.direction);
    return light;
  }
  Light operator()(DirectionalLight light) const {
    light.direction = direction(light.direction);
    return light;
  }
  Light operator()(const ConstantLight& light) const { return light; }
  Light operator()(const EnvironmentLight& light) const { return light; }
};

bool is_environment(const Light& light) {
  return std::holds_alternative<ConstantLight>(light) || std::holds_alternative<EnvironmentLight>(light);
}

/// One that rests while the shutter is open is put where it is then.
void add_moving(Shot& shot, const MovingLight& moving, const ShutterWindow& window) {
  if (window.holds_still(*moving.motion)) {
    shot.lights.back() = placed(moving.light, moving.motion->at(window.open, Side::after));
    return;
  }
  shot.moving_lights.resize(shot.lights.size());
  shot.moving_lights.back() = [moving, window](double time) {
    return placed(moving.light, moving.motion->at(window.scene_time(time), time < 1 ? Side::after : Side::before));
  };
  shot.lights.back() = shot.moving_lights.back()(0);
}

void add_lights_of(Shot& shot, const Scene& scene, const ShutterWindow& window, bool environments) {
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    if (!environments && is_environment(scene.lights[i])) continue;
    shot.lights.push_back(scene.lights[i]);
    const auto moving = scene.moving_lights.find(i);
    if (moving != scene.moving_lights.end()) add_moving(shot, moving->second, window);
  }
}

void add_environment(Shot& shot, const EnvironmentPicture& picture) {
  if (!std::isfinite(picture.rotation_degrees) || !std::isfinite(picture.strength) || picture.strength < 0)
    throw Error(ErrorCode::bad_usage, picture.path,
                "an environment's rotation and strength must be finite, and its strength not negative");
  EnvironmentLight light;
  light.texture = picture.path;
  light.radiance = light.radiance * static_cast<float>(picture.strength);
  const double angle = picture.rotation_degrees * std::numbers::pi / 180;
  light.axes = {Vec3d{std::cos(angle), 0, -std::sin(angle)}, Vec3d{0, 1, 0},
                Vec3d{std::sin(angle), 0, std::cos(angle)}};
  shot.lights.push_back(light);
  shot.light_textures.resize(shot.lights.size());
  shot.light_textures.back() = std::make_shared<const Texture>(read_picture(picture.path), Texture::Encoding::srgb);
}

/// Gives the shot the studio, and says so.
void lend_studio(Shot& shot, const ShotOptions& options, const SceneCamera& camera, const View& view, bool asked_for) {
  const ShutterWindow& window = view.window();
  const Mat4 space_from_camera = inverse_affine(view.camera_from_space(window.open, Side::after));
  const Surroundings around = look_around(shot, transform_point(space_from_camera, {}));
  // Where the camera is at the beginning of all time: the light of a film stays as it is while the camera travels.
  add_studio(shot, camera.motion->at(0, Side::after), around, !options.environment);
  if (asked_for) return;
  shot.notes.push_back(
      around.open < kLeastOpen
          ? "no lights in the scene, and hardly a way out of it: lent it a light at the eye; see --lights"
          : "no lights in the scene: lent it those of a studio; see --lights");
}

}  // namespace

Light placed(const Light& light, const Mat4& world_from_light) { return std::visit(Placer{world_from_light}, light); }

void light_shot(Shot& shot, const Scene& scene, const ShotOptions& options, const SceneCamera& camera, const View& view,
                MemoryBudget& budget) {
  const bool own = options.lights == LightChoice::file || options.lights == LightChoice::automatic;
  if (own) {
    add_lights_of(shot, scene, view.window(), !options.environment);
    if (options.textures)
      shot.light_textures = load_light_textures(scene, shot.lights, options.strict, budget, shot.notes);
  }
  if (options.environment && options.textures) add_environment(shot, *options.environment);
  const bool lacking = options.lights == LightChoice::automatic && !scene.brings_lights && !options.environment;
  if (options.lights == LightChoice::studio || (lacking && reflects_light(shot)))
    lend_studio(shot, options, camera, view, !lacking);
  if (!shot.moving_lights.empty()) shot.moving_lights.resize(shot.lights.size());
  if (!shot.light_textures.empty()) shot.light_textures.resize(shot.lights.size());
}

}  // namespace kairos
