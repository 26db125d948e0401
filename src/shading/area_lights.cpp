#include "shading/area_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shading/luminance.h"
#include "shading/spherical_triangle.h"
#include "shading/surface.h"

namespace kairos {

namespace {

constexpr uint32_t kNoPlace = 0xffffffffu;
/// Leaves of a tree of lights, where not all lights fit in one.
constexpr size_t kLightsPerLeaf = 4;
/// What is farther away than this many times its radius, squared, is weighed as if it were all at its centre: the error
/// is a few per cent, and only makes the choice a little less fitting.
constexpr double kFarSquared = 16;

/// Times area: twice the vector of a triangle's area.
Vec3d double_area(const std::array<Vec3d, 3>& v) { return cross(v[1] - v[0], v[2] - v[0]); }

/// Where it is, over all keys, and which way it shines.
LightBounds bounds_of(const Mesh& mesh, uint32_t triangle, bool front_only, double brightness) {
  const auto corners = [&](size_t key) {
    std::array<Vec3d, 3> v;
    for (size_t i = 0; i < 3; ++i) v[i] = to_double(mesh.position(key, mesh.triangle(triangle)[i]));
    return v;
  };
  LightBounds bounds;
  double area = 0;
  std::vector<Vec3d> normals;
  std::vector<LightBox> boxes;  // [key]
  const size_t keys = mesh.is_static() ? 1 : mesh.key_count();
  for (size_t key = 0; key < keys; ++key) {
    const std::array<Vec3d, 3> v = corners(key);
    boxes.push_back({v[0], v[0]});
    for (const Vec3d& corner : v)
      for (int axis = 0; axis < 3; ++axis) {
        boxes.back().low[axis] = std::min(boxes.back().low[axis], corner[axis]);
        boxes.back().high[axis] = std::max(boxes.back().high[axis], corner[axis]);
      }
    area = std::max(area, length(double_area(v)) / 2);
    normals.push_back(double_area(v));
    if (key + 1 == keys) continue;
    // Between keys the normal is a quadratic curve, which lies within the cone of its three control vectors.
    const std::array<Vec3d, 3> w = corners(key + 1);
    const Vec3d middle = (cross(v[1] - v[0], w[2] - w[0]) + cross(w[1] - w[0], v[2] - v[0])) * 0.5;
    normals.push_back(middle);
    area = std::max(area, length(middle) / 2);
  }
  bounds.set_boxes(boxes, mesh.key_times);
  bounds.power = brightness * area;
  bounds.two_sided = !front_only;
  Vec3d sum;
  for (const Vec3d& normal : normals) sum += normalize(normal);
  bounds.axis = normalize(sum);
  if (bounds.axis == Vec3d{}) return bounds;
  double least = 1;
  for (const Vec3d& normal : normals)
    if (normal != Vec3d{}) least = std::min(least, dot(bounds.axis, normalize(normal)));
  // From a right angle on the cone of the vectors between them is no longer the one around them.
  if (least > 0.01) bounds.spread = std::acos(std::min(1.0, least)) + 1e-6;
  return bounds;
}

double reach_of(Vec3d v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

AreaLights::AreaLights(const Shot& shot, const Looks& looks) : shot_(shot), looks_(looks) {
  std::vector<LightTriangle> found;
  std::vector<LightBounds> bounds;
  for (uint32_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    const Material& material = looks.material(m);
    if (looks.has_emission_texture(m) || material.unlit) continue;
    const float brightness = luminance(material.emission);
    if (!(brightness > 0) || !std::isfinite(brightness)) continue;
    first_.emplace_back(m, place_.size());
    for (uint32_t i = 0; i < mesh.triangle_count(); ++i) {
      const bool front_only = mesh.one_sided || material.one_sided_emission;
      const LightBounds one = bounds_of(mesh, i, front_only, static_cast<double>(brightness));
      if (!(one.power > 0) || !std::isfinite(one.power)) {
        place_.push_back(kNoPlace);
        continue;
      }
      place_.push_back(static_cast<uint32_t>(found.size()));
      const bool is_met = !mesh.one_sided && !material.emits_where_cut_out && !(material.transmission > 0);
      found.push_back({m, i, brightness, front_only, is_met, !mesh.is_static(), triangle_at(mesh, i, 0)});
      bounds.push_back(one);
    }
  }
  tree_ = LightTree(bounds, bounds.size() <= View::kMostInLeaf ? View::kMostInLeaf : kLightsPerLeaf);
  std::vector<uint32_t> place_of(found.size());
  for (const uint32_t light : tree_.order()) {
    place_of[light] = static_cast<uint32_t>(triangles_.size());
    triangles_.push_back(found[light]);
  }
  for (uint32_t& place : place_)
    if (place != kNoPlace) place = place_of[place];
}

std::vector<std::pair<uint32_t, size_t>>::const_iterator AreaLights::first_of(uint32_t mesh) const {
  const auto first = std::lower_bound(first_.begin(), first_.end(), mesh,
                                      [](const auto& entry, uint32_t m) { return entry.first < m; });
  return first != first_.end() && first->first == mesh ? first : first_.end();
}

std::array<Vec3d, 3> AreaLights::View::corners_of(uint32_t place) {
  const LightTriangle& light = lights_.triangles_[place];
  std::array<Vec3d, 3> corners = light.vertices;
  if (light.moves) {
    const Mesh& mesh = lights_.shot_.meshes[light.mesh];
    if (light.mesh != mesh_) key_ = key_position(mesh, time_);
    mesh_ = light.mesh;
    corners = triangle_at(mesh, light.triangle, key_);
  }
  for (Vec3d& corner : corners) corner = corner - point_;
  return corners;
}

float AreaLights::presence(const LightTriangle& light, const std::array<Vec3d, 3>& vertices,
                           const std::array<float, 3>& weights) const {
  const Material& material = looks_.material(light.mesh);
  if (material.alpha_mode == Material::AlphaMode::opaque || material.emits_where_cut_out) return 1;
  const float alpha = looks_.alpha_at(light.mesh, light.triangle, vertices, weights, 0).alpha;
  return material.alpha_mode == Material::AlphaMode::blend ? std::clamp(alpha, 0.0f, 1.0f)
                                                           : (alpha >= material.alpha_cutoff ? 1 : 0);
}

void AreaLights::View::weigh(const LightTree::Leaf& leaf) {
  if (leaf.begin == leaf_.begin && leaf.end == leaf_.end) {
    leaf_ = leaf;
    return;
  }
  leaf_ = leaf;
  sum_ = 0;
  for (uint32_t place = leaf.begin; place < leaf.end; ++place) {
    const LightTriangle& light = lights_.triangles_[place];
    const std::array<Vec3d, 3> v = corners_of(place);
    double& worth = worth_[place - leaf.begin];
    worth = 0;
    const Vec3d normal = double_area(v);
    const double towards = -dot(normal, v[0]);  // times the distance of the point from the plane
    if (light.front_only && !(towards > 0)) continue;
    // In the point's own plane, or nearer to it than shadow rays start off the surface: rounding alone says that light
    // arrives. A lamp's triangle would light its neighbour's back.
    constexpr double kContact = 0x1p-18;
    const double reach = std::max(reach_of(point_), reach_of(v[0] + point_));
    if (std::abs(towards) <= kContact * reach * length(normal)) continue;
    // By the cosine of the corner that stands highest over the surface: where none does, nothing arrives.
    double most = 0;
    for (const Vec3d& corner : v) {
      const double above = dot(normal_, corner);
      if (above > 0) most = std::max(most, above * above / dot(corner, corner));
    }
    if (!(most > 0)) continue;
    const Vec3d centre = (v[0] + v[1] + v[2]) * (1.0 / 3);
    const double squared = dot(centre, centre);
    double radius = 0;
    for (const Vec3d& corner : v) radius = std::max(radius, dot(corner - centre, corner - centre));
    const double solid =
        squared > kFarSquared * radius ? std::abs(towards) / (2 * squared * std::sqrt(squared)) : solid_angle(v);
    worth = static_cast<double>(light.brightness) * solid * std::sqrt(most);
    if (!(worth > 0) || !std::isfinite(worth)) worth = 0;
    sum_ += worth;
  }
}

/// Per steradian, of the direction among those to the triangle; times the choice of it.
double AreaLights::View::density(uint32_t place, const std::array<Vec3d, 3>& corners, double solid,
                                 Vec3d direction) const {
  const double chosen = leaf_.probability * worth_[place - leaf_.begin] / sum_;
  if (solid >= kSmall) return chosen / solid;
  const Vec3d normal = double_area(corners);
  const double across = dot(normal, direction);
  if (across == 0) return 0;
  const double dist = dot(normal, corners[0]) / across;
  return chosen * 2 * dist * dist / std::abs(across);
}

Vec3f AreaLights::View::radiance(uint32_t place, const std::array<Vec3d, 3>& corners, Vec3d direction,
                                 const std::array<Vec3d, 3>& vertices) const {
  const LightTriangle& light = lights_.triangles_[place];
  if (light.front_only && !(dot(double_area(corners), direction) < 0)) return {};
  const Vec3f emission = lights_.looks_.material(light.mesh).emission;
  if (lights_.looks_.material(light.mesh).alpha_mode == Material::AlphaMode::opaque) return emission;
  const std::array<float, 3> weights = barycentrics(vertices, {to_float(point_), to_float(direction)});
  return emission * lights_.presence(light, vertices, weights);
}

std::optional<AreaSample> AreaLights::View::sample(const std::array<float, 3>& sample) {
  auto u = static_cast<double>(sample[0]);
  const LightTree::Leaf leaf = lights_.tree_.choose(point_, normal_, time_, u);
  if (leaf.begin == leaf.end) return std::nullopt;
  weigh(leaf);
  if (!(sum_ > 0)) return std::nullopt;
  uint32_t place = leaf.begin, last = leaf.begin;
  for (double left = u * sum_; place < leaf.end; ++place) {
    const double worth = worth_[place - leaf.begin];
    if (!(worth > 0)) continue;
    last = place;
    if (left < worth) break;
    left -= worth;
  }
  place = last;
  const LightTriangle& light = lights_.triangles_[place];
  const std::array<Vec3d, 3> corners = corners_of(place);
  const double solid = solid_angle(corners);
  Vec3d direction;
  if (solid >= kSmall) {
    direction =
        spherical_triangle_direction(corners, solid, static_cast<double>(sample[1]), static_cast<double>(sample[2]));
  } else {  // uniform on the triangle: G. Turk, in Graphics Gems, 1990
    const double root = std::sqrt(static_cast<double>(sample[1])), along = sample[2];
    direction = normalize(corners[0] * (1 - root) + corners[1] * (root * (1 - along)) + corners[2] * (root * along));
  }
  const Vec3d normal = double_area(corners);
  const double dist = dot(normal, corners[0]) / dot(normal, direction);
  const double how_likely = density(place, corners, solid, direction);
  if (!(dist > 0) || !std::isfinite(dist) || !(how_likely > 0) || !std::isfinite(how_likely)) return std::nullopt;
  std::array<Vec3d, 3> vertices = corners;
  for (Vec3d& vertex : vertices) vertex += point_;
  return AreaSample{direction, dist, radiance(place, corners, direction, vertices), how_likely, light.is_met};
}

std::optional<AreaSample> AreaLights::View::met(uint32_t mesh, uint32_t triangle, Vec3d direction, double dist) {
  const auto first = lights_.first_of(mesh);
  if (first == lights_.first_.end()) return std::nullopt;
  const uint32_t place = lights_.place_[first->second + triangle];
  if (place == kNoPlace || !lights_.triangles_[place].is_met) return std::nullopt;
  const LightTriangle& light = lights_.triangles_[place];
  const std::array<Vec3d, 3> corners = corners_of(place);
  if (light.front_only && !(dot(double_area(corners), direction) < 0)) return std::nullopt;
  const LightTree::Leaf leaf = lights_.tree_.leaf_of(place, point_, normal_, time_);
  double how_likely = 0;
  if (leaf.begin != leaf.end && leaf.probability > 0) {
    weigh(leaf);
    if (sum_ > 0) how_likely = density(place, corners, solid_angle(corners), direction);
  }
  if (!std::isfinite(how_likely)) how_likely = 0;
  return AreaSample{direction, dist, lights_.looks_.material(light.mesh).emission, how_likely};
}

}  // namespace kairos
