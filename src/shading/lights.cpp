#include "shading/lights.h"

#include <algorithm>
#include <cmath>

#include "shading/luminance.h"
#include "shading/surface.h"

namespace kairos {

namespace {

struct Arrival {
  Vec3d point;
  const Place& place;

  std::optional<ArrivingLight> operator()(const PointLight& light) const {
    const Vec3d way = place.point_from_world(to_double(light.position)) - point;
    const double dist_squared = dot(way, way);
    if (!(dist_squared > 0)) return std::nullopt;
    return ArrivingLight{normalize(way), std::sqrt(dist_squared), light.intensity / static_cast<float>(dist_squared)};
  }
  std::optional<ArrivingLight> operator()(const SpotLight& light) const {
    auto arriving = (*this)(PointLight{light.position, light.intensity});
    if (!arriving) return arriving;
    const double cosine = -dot(arriving->direction, place.vector_from_world(to_double(light.direction)));
    const double inner = light.cos_inner, outer = light.cos_outer;
    if (cosine <= outer) return std::nullopt;
    const double falloff = inner > outer ? std::min(1.0, (cosine - outer) / (inner - outer)) : 1.0;
    arriving->irradiance = arriving->irradiance * static_cast<float>(falloff * falloff);
    return arriving;
  }
  std::optional<ArrivingLight> operator()(const DirectionalLight& light) const {
    const Vec3d direction = normalize(place.vector_from_world(-to_double(light.direction)));
    return ArrivingLight{direction, std::numeric_limits<double>::infinity(), light.irradiance};
  }
  std::optional<ArrivingLight> operator()(const ConstantLight&) const { return std::nullopt; }
  std::optional<ArrivingLight> operator()(const EnvironmentLight&) const { return std::nullopt; }
};

double area_of(const std::array<Vec3d, 3>& v) { return length(cross(v[1] - v[0], v[2] - v[0])) / 2; }

/// Its mean over time, by Simpson's rule between each two keys: exact where the triangle keeps its plane and
/// orientation, and zero only for one that never has an area.
double mean_area(const Mesh& mesh, uint32_t triangle) {
  const auto at = [&](size_t key) {
    std::array<Vec3d, 3> corners;
    for (size_t i = 0; i < 3; ++i) corners[i] = to_double(mesh.positions[key][mesh.triangles[triangle][i]]);
    return corners;
  };
  if (mesh.is_static()) return area_of(at(0));
  double sum = 0;
  for (size_t key = 0; key + 1 < mesh.key_count(); ++key) {
    const std::array<Vec3d, 3> first = at(key), last = at(key + 1);
    std::array<Vec3d, 3> middle;
    for (size_t i = 0; i < 3; ++i) middle[i] = lerp(first[i], last[i], 0.5);
    const double duration = static_cast<double>(mesh.key_times[key + 1]) - static_cast<double>(mesh.key_times[key]);
    sum += duration * (area_of(first) + 4 * area_of(middle) + area_of(last)) / 6;
  }
  return sum;
}

}  // namespace

Lights::Lights(const Shot& shot, const Looks& looks, const Sky& sky)
    : shot_(shot), looks_(looks), sky_(sky), background_(shot.background) {
  for (size_t i = 0; i < shot.lights.size(); ++i) {
    const Light& light = shot.lights[i];
    if (const auto* constant = std::get_if<ConstantLight>(&light)) {
      environment_ += constant->radiance;
    } else if (const auto* picture = std::get_if<EnvironmentLight>(&light)) {
      const bool is_there = i < shot.light_textures.size() && shot.light_textures[i];
      if (!is_there) environment_ += picture->radiance;
    } else {
      punctual_.push_back({light, i < shot.moving_lights.size() ? shot.moving_lights[i] : nullptr});
    }
  }
  add_areas();
}

void Lights::add_areas() {
  double sum = 0;
  for (uint32_t m = 0; m < shot_.meshes.size(); ++m) {
    const Mesh& mesh = shot_.meshes[m];
    if (looks_.has_emission_texture(m) || looks_.material(m).unlit) continue;
    const double radiance = luminance(looks_.material(m).emission);
    if (!(radiance > 0) || !std::isfinite(radiance)) continue;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      sum += radiance * mean_area(mesh, i);
      areas_.push_back({m, i, sum});
    }
  }
  if (!(sum > 0) || !std::isfinite(sum)) return areas_.clear();
  for (AreaTriangle& one : areas_) one.end /= sum;
}

float Lights::presence(uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                       const std::array<float, 3>& weights) const {
  const Material& material = looks_.material(mesh);
  if (material.alpha_mode == Material::AlphaMode::opaque || material.emits_where_cut_out) return 1;
  const float alpha = looks_.alpha_at(mesh, triangle, vertices, weights, 0).alpha;
  return material.alpha_mode == Material::AlphaMode::blend ? std::clamp(alpha, 0.0f, 1.0f)
                                                           : (alpha >= material.alpha_cutoff ? 1 : 0);
}

std::optional<ArrivingLight> Lights::punctual(size_t index, Vec3d point, float time, const Place& place) const {
  const Punctual& one = punctual_[index];
  if (!one.at) return std::visit(Arrival{point, place}, one.light);
  return std::visit(Arrival{point, place}, one.at(static_cast<double>(time)));
}

std::optional<ArrivingLight> Lights::area(Vec3d point, float time, const std::array<float, 3>& sample) const {
  const auto above = std::upper_bound(areas_.begin(), areas_.end(), static_cast<double>(sample[0]),
                                      [](double value, const AreaTriangle& one) { return value < one.end; });
  const auto chosen = above == areas_.end() ? areas_.end() - 1 : above;
  const double probability = chosen->end - (chosen == areas_.begin() ? 0 : (chosen - 1)->end);
  const Mesh& mesh = shot_.meshes[chosen->mesh];
  const std::array<Vec3d, 3> v = triangle_at(mesh, chosen->triangle, time);
  // Uniform on the triangle: G. Turk, in Graphics Gems, 1990.
  const double root = std::sqrt(static_cast<double>(sample[1])), along = sample[2];
  const std::array<float, 3> weights{static_cast<float>(1 - root), static_cast<float>(root * (1 - along)),
                                     static_cast<float>(root * along)};
  const Vec3d target = point_of(v, weights);
  const Vec3d way = target - point;
  const double dist_squared = dot(way, way), dist = std::sqrt(dist_squared);
  if (!(dist > 0) || !(probability > 0)) return std::nullopt;
  const double towards = -dot(geometric_normal(v), way);
  const Material& material = shot_.materials[mesh.material];
  // What is seen from its front alone shines from there alone, too.
  if ((mesh.one_sided || material.one_sided_emission) && !(towards > 0)) return std::nullopt;
  const double cosine = std::abs(towards) / dist;
  const Vec3f emission = material.emission;
  const double factor =
      presence(chosen->mesh, chosen->triangle, v, weights) * cosine * area_of(v) / (dist_squared * probability);
  if (!(factor > 0) || !std::isfinite(factor)) return std::nullopt;
  return ArrivingLight{way / dist, dist, emission * static_cast<float>(factor)};
}

}  // namespace kairos
