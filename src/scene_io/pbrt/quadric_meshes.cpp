#include "scene_io/pbrt/quadric_meshes.h"

namespace kairos::pbrt {

std::shared_ptr<const Geometry> quadric_geometry(const Quadric& quadric, int steps_of_a_turn) {
  auto geometry = std::make_shared<Geometry>(*make_geometry(tessellate(quadric, steps_of_a_turn)));
  geometry->is_one_shape = true;
  return geometry;
}

std::shared_ptr<const Geometry> QuadricMeshes::mesh_of(const Quadric& q, const TransformPath& world_from_shape) {
  const int steps =
      screen_ ? steps_for(q.widest() * screen_->pixels_per_unit(world_from_shape, {}, q.reach())) : kUnseenSteps;
  const Key key{
      q.kind,
      {q.phi_max, q.radius, q.inner_radius, q.z_min, q.z_max, q.from.x, q.from.y, q.from.z, q.to.x, q.to.y, q.to.z},
      steps};
  std::shared_ptr<const Geometry>& mesh = meshes_[key];
  if (!mesh) mesh = quadric_geometry(q, steps);
  return mesh;
}

}  // namespace kairos::pbrt
