// The triangles of quadrics: as many as each one's size in the picture asks for, shared where shapes are equal.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/quadric.h"
#include "scene_io/pbrt/screen.h"

namespace kairos::pbrt {

class QuadricMeshes {
 public:
  /// Without a screen (the file has no camera) all have as many steps as one that is 600 pixels wide.
  explicit QuadricMeshes(const std::optional<Screen>& screen) : screen_(screen) {}

  std::shared_ptr<const Geometry> mesh_of(const Quadric& quadric, const TransformPath& world_from_shape);

 private:
  using Key = std::tuple<Quadric::Kind, std::array<double, 11>, int>;

  const std::optional<Screen>& screen_;
  std::map<Key, std::shared_ptr<const Geometry>> meshes_;
};

/// The same with a number of steps of its own.
std::shared_ptr<const Geometry> quadric_geometry(const Quadric& quadric, int steps_of_a_turn);

}  // namespace kairos::pbrt
