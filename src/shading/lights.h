// What lights a scene: lights of the scene file, emissive meshes, the environment.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <kairos/scene.h>

#include "shading/area_lights.h"
#include "shading/light_tree.h"
#include "shading/looks.h"
#include "shading/sky.h"

namespace kairos {

/// Where the shot's space is in the world at an instant.
struct Place {
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< of the shot's space, in the world
  Vec3d origin;

  Vec3d vector_to_world(Vec3d v) const { return axes[0] * v.x + axes[1] * v.y + axes[2] * v.z; }
  Vec3d vector_from_world(Vec3d v) const { return {dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)}; }
  Vec3d point_from_world(Vec3d p) const { return vector_from_world(p - origin); }
};

/// Light that arrives at a point from one direction, if nothing is in between.
struct ArrivingLight {
  Vec3d direction;  ///< unit, towards the light, in the shot's space
  double dist = std::numeric_limits<double>::infinity();
  Vec3f irradiance;  ///< on a surface that faces it
};

/// Reads the shot, the looks and the sky, which must outlive it. Safe to use from many threads at once.
class Lights {
 public:
  Lights(const Shot& shot, const Looks& looks, const Sky& sky);

  /// Point, spot and directional lights that are each to be asked. Of up to kMostAsked point and spot lights all are;
  /// where there are more, one is chosen by chance.
  size_t punctual_count() const { return asked_.size(); }
  /// Where the light is at the time. Nothing where it does not reach.
  std::optional<ArrivingLight> punctual(size_t index, Vec3d point, float time, const Place& place) const {
    return arriving(asked_[index], point, time, place);
  }
  /// Does it stand still in the world?
  bool rests(size_t index) const { return asked_[index].at == nullptr; }
  /// Do all lights?
  bool rest() const { return rest_; }
  bool has_many() const { return !many_.empty(); }
  /// One of all others, by what it is worth, divided by its probability: the expectation is the irradiance of them all
  /// on a surface with this normal. u: uniform in [0, 1).
  std::optional<ArrivingLight> one_of_many(Vec3d point, Vec3d normal, float time, const Place& place, float u) const;
  static constexpr size_t kMostAsked = 16;

  /// Is there any light? asked: count those that are each to be asked.
  bool any(bool asked) const {
    return (asked && punctual_count() > 0) || has_many() || !areas_.empty() || has_environment() || !sky_.empty();
  }

  /// Emissive meshes.
  const AreaLights& areas() const { return areas_; }

  /// The same from everywhere.
  bool has_environment() const { return environment_ != Vec3f{}; }
  Vec3f environment() const { return environment_; }
  /// From pictures.
  const Sky& sky() const { return sky_; }
  /// What a reflected or refracted ray sees that leaves the scene: the environment, or else the background. direction:
  /// unit, in the world; width: of its cone, in radians.
  Vec3f beyond(Vec3d direction, double width) const {
    const Vec3f even = has_environment() || !sky_.empty() ? environment_ : background_;
    return sky_.empty() ? even : even + sky_.radiance(direction, width);
  }

 private:
  struct Punctual {
    Light light;
    std::function<Light(double)> at;  // null: it stands still
  };
  static std::optional<ArrivingLight> arriving(const Punctual& light, Vec3d point, float time, const Place& place);
  static LightBounds bounds_of(const Punctual& light);

  const Sky& sky_;
  std::vector<Punctual> asked_, many_;  // the latter in the order of the tree
  LightTree tree_;                      // of many_, in the world
  AreaLights areas_;
  Vec3f environment_, background_;
  bool rest_ = true;
};

}  // namespace kairos
