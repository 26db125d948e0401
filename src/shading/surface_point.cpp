#include "shading/surface_point.h"

#include <algorithm>
#include <cmath>

#include "shading/normal_map.h"
#include "shading/surface.h"

namespace kairos {

namespace {

// A secondary ray starts this far off its surface, as a part of the largest coordinate of the triangle that it leaves:
// sixty roundings of a float, where the intersection of a ray with a triangle of that size makes about ten.
constexpr double kOffset = 0x1p-18;

double largest_coordinate(Vec3d p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

}  // namespace

SurfacePoints::SurfacePoints(const Shot& shot, const Looks& looks)
    : shot_(shot), looks_(looks), world_from_camera_(shot) {
  has_local_lights_ = std::any_of(shot.lights.begin(), shot.lights.end(), [](const Light& light) {
    return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light);
  });
}

SampleInstant SurfacePoints::instant(float time) const {
  SampleInstant instant{time, {}};
  instant.place.axes = world_from_camera_.at(time);
  if (has_local_lights_ && shot_.camera_position)
    instant.place.origin = shot_.camera_position(static_cast<double>(time));
  return instant;
}

SurfacePoint SurfacePoints::at(const Ray& ray, uint32_t mesh_index, uint32_t triangle, double width,
                               const SampleInstant& instant) const {
  const Mesh& mesh = shot_.meshes[mesh_index];
  const std::array<Vec3d, 3> vertices = triangle_at(mesh, triangle, instant.time);
  const std::array<float, 3> weights = barycentrics(vertices, ray);
  SurfacePoint p;
  p.mesh = mesh_index;
  p.triangle = triangle;
  p.material = &looks_.material(mesh_index);
  p.look = looks_.at(mesh_index, triangle, vertices, weights, width);
  p.weights = weights;
  p.position = point_of(vertices, weights);
  p.to_viewer = -normalize(to_double(ray.direction));
  p.face = geometric_normal(vertices);
  p.width = width;
  p.entering = dot(p.face, p.to_viewer) >= 0;
  if (!p.entering) p.face = -p.face;
  if (!p.entering && p.material->one_sided_emission) p.look.emission = {};
  p.normal = p.face;
  const Vec3f own = interpolated_normal(mesh, triangle, weights, instant.time);
  if (own != Vec3f{}) {
    p.normal = normalize(instant.place.vector_from_world(to_double(own)));
    if (dot(p.normal, p.face) < 0) p.normal = -p.normal;
    if (!(dot(p.normal, p.to_viewer) > 0)) p.normal = p.face;  // seen from behind, at the rim of something smooth
  }
  if (looks_.has_normal_texture(mesh_index)) p.normal = bent_normal(p, vertices, weights, instant);
  const double extent =
      std::max({largest_coordinate(vertices[0]), largest_coordinate(vertices[1]), largest_coordinate(vertices[2])});
  p.offset = extent * kOffset;
  return p;
}

Vec3d SurfacePoints::bent_normal(const SurfacePoint& p, const std::array<Vec3d, 3>& vertices,
                                 const std::array<float, 3>& weights, const SampleInstant& instant) const {
  const Mesh& mesh = shot_.meshes[p.mesh];
  const double seen = p.entering ? 1 : -1;
  const Vec3d front = p.normal * seen;
  TangentFrame frame;
  if (mesh.tangent_key_count() != 0) {
    const Vec4f own = interpolated_tangent(mesh, p.triangle, weights, instant.time);
    frame = tangent_frame(instant.place.vector_from_world(Vec3d{own.x, own.y, own.z}), own.w, front);
  } else {
    frame = tangent_frame(vertices, looks_.normal_uvs(p.mesh, p.triangle), front);
  }
  Vec3f bend = looks_.normal_at(p.mesh, p.triangle, vertices, weights, p.width);
  bend.x *= p.material->normal_scale;
  bend.y *= p.material->normal_scale;
  return mapped_normal(bend, frame, front, seen, p.to_viewer);
}

}  // namespace kairos
