#include "shading/shader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shading/paths.h"
#include "shading/reflectance.h"
#include "shading/smooth_joint.h"
#include "shading/surface.h"
#include "shading/whitted.h"

namespace kairos {

namespace {

bool mostly_shows_others(const Material& material) {
  const Look look{material.base_color, {}, 1, material.metallic, material.roughness};
  const Reflectance shares = reflectance(material, look, 1, true);
  return !material.unlit && largest(shares.mirror + shares.through) > largest(shares.diffuse + shares.highlight);
}

}  // namespace

Shader::Shader(const Shot& shot, ShadingKind kind, bool want_normal, int max_depth,
               std::shared_ptr<const DiscreteScene> discrete, bool want_variation, float clamp)
    : shot_(shot),
      looks_(std::make_unique<const Looks>(shot)),
      sky_(std::make_unique<const Sky>(shot, kairos::is_lit(kind))),
      cone_(shot.projection),
      world_from_camera_(shot),
      kind_(kind),
      want_normal_(want_normal || kind == ShadingKind::normal) {
  cut_outs_ = std::make_shared<const AlphaCutOuts>(shot, *looks_);
  if (!cut_outs_->any()) cut_outs_.reset();
  if (kairos::is_lit(kind)) {
    if (!discrete)
      discrete =
          std::make_shared<const DiscreteScene>(shot.meshes, DiscreteOptions{true, cut_outs_, 0, panes_of(shot)});
    if (kind == ShadingKind::path)
      lit_ = std::make_unique<const Paths>(shot, *looks_, *sky_, std::move(discrete), cone_.spread(),
                                           PathOptions{max_depth, clamp});
    else
      lit_ = std::make_unique<const Whitted>(shot, *looks_, *sky_, std::move(discrete), cone_.spread(), max_depth);
  }
  for (uint32_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    const bool still = mesh.is_static() && mesh.normal_key_count() < 2 && !shot.camera_moves;
    varies_.push_back(lit_ || ((want_normal_ || looks_->varies(m)) && !still));
    shows_others_.push_back(lit_ && mostly_shows_others(looks_->material(m)));
    is_even_.push_back(!lit_ && (kind == ShadingKind::normal || !looks_->varies(m)));
  }
  if (want_variation && want_normal_ && !lit_) variation_ = ColourVariation(shot, world_from_camera_);
}

bool Shader::joined(const Segment& first, const Segment& second) const {
  if (first.mesh != second.mesh) return false;
  const JointNeeds needs{want_normal_ || lit_, looks_->varies(first.mesh)};
  if (!needs.normals && !needs.looks) return true;  // of one colour all over
  if (first.front != second.front) return false;
  return first.triangle == second.triangle ||
         smooth_joint(shot_.meshes[first.mesh], first.triangle, second.triangle, first.end, needs);
}

Vec3f Shader::normal(const Ray& ray, uint32_t mesh_index, uint32_t triangle, float time) const {
  const Mesh& mesh = shot_.meshes[mesh_index];
  const std::array<Vec3d, 3> vertices = triangle_at(mesh, triangle, time);
  if (mesh.normal_key_count() != 0) {
    const Vec3f own = interpolated_normal(mesh, triangle, barycentrics(vertices, ray), time);
    if (own != Vec3f{}) return own;
  }
  const Vec3d n = geometric_normal(vertices);
  const auto axes = world_from_camera_.at(time);
  return to_float(normalize(axes[0] * n.x + axes[1] * n.y + axes[2] * n.z));
}

Vec3f Shader::sky(const Ray& ray, float time) const {
  if (!has_sky()) return shot_.seen_background();
  const std::array<Vec3d, 3> axes = world_from_camera_.at(time);
  const Vec3d along = normalize(to_double(ray.direction));
  return shot_.limited(shot_.background +
                       sky_->radiance(axes[0] * along.x + axes[1] * along.y + axes[2] * along.z, cone_.spread()));
}

Look Shader::look(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double& width) const {
  if (!looks_->varies(mesh) && !lit_) return looks_->at(mesh, triangle, {}, {}, 0);
  const std::array<Vec3d, 3> vertices = triangle_at(shot_.meshes[mesh], triangle, time);
  const std::array<float, 3> weights = barycentrics(vertices, ray);
  width = cone_.width_at(point_of(vertices, weights), ray);
  return looks_->at(mesh, triangle, vertices, weights, width);
}

bool Shader::shines(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
  if (!looks_->material(mesh).one_sided_emission) return true;
  const std::array<Vec3d, 3> vertices = triangle_at(shot_.meshes[mesh], triangle, time);
  return dot(geometric_normal(vertices), to_double(ray.direction)) < 0;
}

Shade Shader::shade_unlit(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double& width) const {
  Shade shade;
  const Look seen = look(ray, mesh, triangle, time, width);
  shade.albedo = seen.base_colour;
  if (want_normal_) shade.normal = normal(ray, mesh, triangle, time);
  switch (kind_) {
    case ShadingKind::normal:
      shade.colour = {std::abs(shade.normal.x), std::abs(shade.normal.y), std::abs(shade.normal.z)};
      break;
    case ShadingKind::bounds:  // shows no surfaces, and so does not ask
    case ShadingKind::bounds_exact:
    case ShadingKind::flat:
      shade.colour = seen.base_colour;
      if (const Material& material = looks_->material(mesh); !material.unlit && shines(ray, mesh, triangle, time))
        shade.colour = material.lamp ? seen.emission : shade.colour + seen.emission;
      break;
    case ShadingKind::whitted:
    case ShadingKind::path:
      break;
  }
  shade.colour = shot_.limited(shade.colour);
  return shade;
}

Vec3f Shader::unlit_colour(const ShadingQuery& query) const {
  const Vec3f n = normal(query.ray, query.mesh, query.triangle, query.time);
  double width = 0;
  return look(query.ray, query.mesh, query.triangle, query.time, width).base_colour *
         Vec3f{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
}

Shade Shader::shade(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, SampleKey key) const {
  double width = 0;
  Shade shade = shade_unlit(ray, mesh, triangle, time, width);
  if (!lit_) return shade;
  const ShadingQuery query{ray, mesh, triangle, time, width, key};
  Vec3f colour;
  lit_->radiance({&query, 1}, {&colour, 1});
  shade.colour = shot_.limited(colour);
  return shade;
}

void Shader::resting_light(ShadingQuery& query, std::vector<RestingLight>& lights) const {
  look(query.ray, query.mesh, query.triangle, query.time, query.width);
  lit_->resting_light(query, lights);
}

bool Shader::steady_light(ShadingQuery& query, std::vector<RestingLight>& lights, Shade& base) const {
  base = shade_unlit(query.ray, query.mesh, query.triangle, query.time, query.width);
  return lit_->steady_light(query, lights, base.colour);
}

std::vector<bool> Shader::resting_receivers() const {
  std::vector<bool> rest(shot_.meshes.size());
  if (!lit_ || shot_.camera_moves) return rest;
  for (uint32_t m = 0; m < shot_.meshes.size(); ++m) {
    const Mesh& mesh = shot_.meshes[m];
    const Material& material = looks_->material(m);
    if (mesh.one_sided || material.transmission > 0 || (cut_outs_ && cut_outs_->is_blended(m)))
      return std::vector<bool>(rest.size());
    rest[m] = mesh.is_static() && mesh.normal_key_count() < 2 && !material.unlit;
  }
  return rest;
}

std::vector<bool> Shader::resting_mirrors() const {
  std::vector<bool> rest(shot_.meshes.size());
  if (kind_ != ShadingKind::whitted || shot_.camera_moves) return rest;
  for (uint32_t m = 0; m < shot_.meshes.size(); ++m) {
    const Mesh& mesh = shot_.meshes[m];
    if (cut_outs_ && cut_outs_->is_blended(m)) return std::vector<bool>(rest.size());
    rest[m] = mesh.is_static() && mesh.normal_key_count() < 2 && shows_others_[m];
  }
  return rest;
}

void Shader::shade(std::span<ShadingQuery> queries, std::span<Shade> shades) const {
  for (size_t i = 0; i < queries.size(); ++i) {
    ShadingQuery& query = queries[i];
    shades[i] = shade_unlit(query.ray, query.mesh, query.triangle, query.time, query.width);
  }
  if (!lit_) return;
  constexpr size_t kAtOnce = 64;
  std::array<Vec3f, kAtOnce> colours;
  for (size_t begin = 0; begin < queries.size(); begin += kAtOnce) {
    const size_t count = std::min(kAtOnce, queries.size() - begin);
    lit_->radiance(queries.subspan(begin, count), std::span(colours).first(count));
    for (size_t i = 0; i < count; ++i) shades[begin + i].colour = shot_.limited(colours[i]);
  }
}

}  // namespace kairos
