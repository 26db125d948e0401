#include "shading/whitted.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shading/normal_map.h"
#include "shading/reflectance.h"
#include "shading/surface.h"

namespace kairos {

namespace {

// A secondary ray starts this far off its surface, as a part of the largest coordinate of the triangle that it leaves:
// sixty roundings of a float, where the intersection of a ray with a triangle of that size makes about ten.
constexpr double kOffset = 0x1p-18;
// Shadow rays end this part of their length before the light's surface, for the same reason.
constexpr double kShadowEnd = 1 - 0x1p-16;
// A reflection that would add less than this part of its colour to the picture is left out: half a step of 8 bits.
constexpr float kLeastWeight = 1.0f / 512;
// How many panes of glass a shadow ray goes through.
constexpr int kMostPanes = 32;
// Branches of a sample's key.
constexpr uint64_t kAreaBranch = 11, kEnvironmentBranch = 12, kMirrorBranch = 13, kThroughBranch = 14, kSkyBranch = 15,
                   kScatterBranch = 16;

float largest(Vec3f c) { return std::max({c.x, c.y, c.z}); }
double largest_coordinate(Vec3d p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
Vec3d reflected(Vec3d direction, Vec3d normal) { return direction - normal * (2 * dot(direction, normal)); }

/// eta: refractive index ahead over that behind; normal: towards where the ray comes from. The ray must not be totally
/// reflected.
Vec3d refracted(Vec3d direction, Vec3d normal, double eta) {
  const double cosine = -dot(direction, normal);
  const double inside = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (eta * eta)));
  return normalize(direction / eta + normal * (cosine / eta - inside));
}

/// Distributed as the cosine over the hemisphere around `normal`.
Vec3d cosine_direction(Vec3d normal, float u, float v) {
  const double radius = std::sqrt(static_cast<double>(u)), angle = 2 * std::numbers::pi * static_cast<double>(v);
  const auto [x, y] = axes_across(normal);
  return normalize(x * (radius * std::cos(angle)) + y * (radius * std::sin(angle)) +
                   normal * std::sqrt(std::max(0.0, 1 - static_cast<double>(u))));
}

}  // namespace

struct Whitted::Instant {
  float time;
  Place place;
};

struct Whitted::Point {
  const Material* material;
  Look look;
  Vec3d position, to_viewer;
  Vec3d face;    // the triangle's normal, unit, on the viewer's side
  Vec3d normal;  // the interpolated one, on the viewer's side
  bool entering;
  double offset, width;
  Reflectance shares;

  /// The start of a ray on the viewer's side (side 1) or on the other (-1).
  Ray ray(Vec3d direction, double side) const {
    return {to_float(position + face * (side * offset)), to_float(direction)};
  }
};

Whitted::Whitted(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
                 double cone_spread, int max_depth)
    : shot_(shot),
      looks_(looks),
      lights_(shot, looks, sky),
      scene_(std::move(scene)),
      cone_spread_(cone_spread),
      max_depth_(max_depth) {}

Whitted::Point Whitted::point_at(const Ray& ray, uint32_t mesh_index, uint32_t triangle, double width,
                                 const Instant& instant) const {
  const Mesh& mesh = shot_.meshes[mesh_index];
  const std::array<Vec3d, 3> vertices = triangle_at(mesh, triangle, instant.time);
  const std::array<float, 3> weights = barycentrics(vertices, ray);
  Point p;
  p.material = &looks_.material(mesh_index);
  p.look = looks_.at(mesh_index, triangle, vertices, weights, width);
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
  if (looks_.has_normal_texture(mesh_index))
    p.normal = bent_normal(p, mesh_index, triangle, vertices, weights, instant);
  const double extent =
      std::max({largest_coordinate(vertices[0]), largest_coordinate(vertices[1]), largest_coordinate(vertices[2])});
  p.offset = extent * kOffset;
  p.shares = reflectance(*p.material, p.look, std::clamp(dot(p.normal, p.to_viewer), 0.0, 1.0), p.entering);
  return p;
}

Vec3d Whitted::bent_normal(const Point& p, uint32_t mesh_index, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                           const std::array<float, 3>& weights, const Instant& instant) const {
  const Mesh& mesh = shot_.meshes[mesh_index];
  const double seen = p.entering ? 1 : -1;
  const Vec3d front = p.normal * seen;
  TangentFrame frame;
  if (!mesh.tangents.empty()) {
    const Vec4f own = interpolated_tangent(mesh, triangle, weights, instant.time);
    frame = tangent_frame(instant.place.vector_from_world(Vec3d{own.x, own.y, own.z}), own.w, front);
  } else {
    frame = tangent_frame(vertices, looks_.normal_uvs(mesh_index, triangle), front);
  }
  Vec3f bend = looks_.normal_at(mesh_index, triangle, vertices, weights, p.width);
  bend.x *= p.material->normal_scale;
  bend.y *= p.material->normal_scale;
  return mapped_normal(bend, frame, front, seen, p.to_viewer);
}

Vec3f Whitted::radiance(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double width,
                        SampleKey key) const {
  Instant instant{time, {}};
  if (shot_.world_from_camera) instant.place.axes = shot_.world_from_camera(static_cast<double>(time));
  if (shot_.camera_position) instant.place.origin = shot_.camera_position(static_cast<double>(time));
  const Vec3f colour = shade(ray, point_at(ray, mesh, triangle, width, instant), instant, key, 0, 1);
  return is_finite(colour) ? colour : Vec3f{};
}

Vec3f Whitted::shade(const Ray& ray, const Point& point, const Instant& instant, SampleKey key, int depth,
                     float weight) const {
  if (point.face == Vec3d{}) return {};  // no area
  if (point.material->unlit) return point.look.base_colour;
  Vec3f colour = point.look.emission + direct(point, instant, key);
  if (depth >= max_depth_) return colour;
  const Vec3d along = normalize(to_double(ray.direction));
  const auto follow = [&](Vec3f share, Vec3d direction, double side, uint64_t branch) {
    const float rest = weight * largest(share);
    if (rest < kLeastWeight) return;
    colour += share * from(point.ray(direction, side), point.width, instant, key.branch(branch), depth + 1, rest);
  };
  Vec3d mirrored = reflected(along, point.normal);
  if (!(dot(mirrored, point.face) > 0)) mirrored = reflected(along, point.face);
  follow(point.shares.mirror, mirrored, 1, kMirrorBranch);
  const double ior = std::max(1.0f, point.material->ior);
  const double eta = point.material->thin_walled ? 1 : point.entering ? ior : 1 / ior;
  Vec3d inwards = refracted(along, point.normal, eta);
  if (!(dot(inwards, point.face) < 0)) inwards = along;
  follow(point.shares.through, inwards, -1, kThroughBranch);
  return colour;
}

Vec3f Whitted::from(const Ray& ray, double width, const Instant& instant, SampleKey key, int depth,
                    float weight) const {
  const auto hit = scene_->intersect(ray, instant.time);
  if (!hit) return lights_.beyond(instant.place.vector_to_world(normalize(to_double(ray.direction))), cone_spread_);
  const double there = width + cone_spread_ * static_cast<double>(hit->dist);
  return shade(ray, point_at(ray, hit->mesh, hit->triangle, there, instant), instant, key, depth, weight);
}

Vec3f Whitted::direct(const Point& point, const Instant& instant, SampleKey key) const {
  const Reflectance& shares = point.shares;
  if (largest(shares.diffuse) + largest(shares.highlight) <= 0) return {};
  Vec3f colour{};
  const auto add = [&](const std::optional<ArrivingLight>& light) {
    if (!light) return;
    const double cosine = dot(point.normal, light->direction);
    if (!(cosine > 0) || !(dot(point.face, light->direction) > 0)) return;
    const Vec3f open = transmittance(point, light->direction, light->dist, instant);
    if (open == Vec3f{}) return;
    const double lobe = highlight_lobe(point.normal, point.to_viewer, light->direction, shares.alpha);
    colour +=
        (shares.diffuse * static_cast<float>(1 / std::numbers::pi) + shares.highlight * static_cast<float>(lobe)) *
        (light->irradiance * open * static_cast<float>(cosine));
  };
  for (size_t i = 0; i < lights_.punctual_count(); ++i)
    add(lights_.punctual(i, point.position, instant.time, instant.place));
  if (lights_.has_areas()) add(lights_.area(point.position, instant.time, light_point(key.branch(kAreaBranch))));
  if (lights_.has_environment()) {
    const std::array<float, 3> sample = light_point(key.branch(kEnvironmentBranch));
    const Vec3d direction = cosine_direction(point.normal, sample[0], sample[1]);
    if (dot(point.face, direction) > 0) {
      const Vec3f open = transmittance(point, direction, std::numeric_limits<double>::infinity(), instant);
      colour += (shares.diffuse + shares.highlight) * lights_.environment() * open;
    }
  }
  if (!lights_.sky().empty()) colour += from_sky(point, instant, key);
  return colour;
}

/// Two directions: one by the sky's brightness, one by how the surface scatters. Each is weighed as if either could
/// have been chosen either way: the balance heuristic of E. Veach and L. Guibas 1995.
Vec3f Whitted::from_sky(const Point& point, const Instant& instant, SampleKey key) const {
  const Sky& sky = lights_.sky();
  const Reflectance& shares = point.shares;
  const auto even = static_cast<double>(largest(shares.diffuse));
  const double by_cosine = even / (even + static_cast<double>(largest(shares.highlight)));
  const auto seen_in = [&](Vec3d direction) -> Vec3f {
    const double cosine = dot(point.normal, direction);
    if (!(cosine > 0) || !(dot(point.face, direction) > 0)) return {};
    const Vec3d in_world = instant.place.vector_to_world(direction);
    const double density = sky.density(in_world) + by_cosine * cosine / std::numbers::pi +
                           (1 - by_cosine) * lobe_density(point.normal, point.to_viewer, direction, shares.alpha);
    const Vec3f radiance = sky.radiance(in_world);
    if (!(density > 0) || radiance == Vec3f{}) return {};
    const Vec3f open = transmittance(point, direction, std::numeric_limits<double>::infinity(), instant);
    const double lobe = highlight_lobe(point.normal, point.to_viewer, direction, shares.alpha);
    return (shares.diffuse * static_cast<float>(1 / std::numbers::pi) + shares.highlight * static_cast<float>(lobe)) *
           (radiance * open * static_cast<float>(cosine / density));
  };
  const auto bright = sky.sample(light_point(key.branch(kSkyBranch)));
  if (!bright) return {};  // all black
  const std::array<float, 3> sample = light_point(key.branch(kScatterBranch));
  const Vec3d scattered = static_cast<double>(sample[2]) < by_cosine
                              ? cosine_direction(point.normal, sample[0], sample[1])
                              : lobe_direction(point.normal, point.to_viewer, shares.alpha, sample[0], sample[1]);
  return seen_in(instant.place.vector_from_world(*bright)) + seen_in(scattered);
}

Vec3f Whitted::transmittance(const Point& point, Vec3d direction, double dist, const Instant& instant) const {
  Vec3f open{1, 1, 1};
  Ray ray = point.ray(direction, 1);
  dist -= 2 * point.offset;
  for (int pane = 0; pane < kMostPanes; ++pane) {
    const auto hit = scene_->intersect(ray, instant.time, static_cast<float>(dist * kShadowEnd), Facing::far_end);
    if (!hit) return open;
    if (!(looks_.material(hit->mesh).transmission > 0)) return {};
    const Point glass = point_at(ray, hit->mesh, hit->triangle, point.width, instant);
    // As if it entered at every face: light that comes through bent is not lost at the far side.
    const double cosine = std::clamp(dot(glass.normal, glass.to_viewer), 0.0, 1.0);
    open = open * reflectance(*glass.material, glass.look, cosine, true).through;
    if (largest(open) < kLeastWeight) return {};
    ray = glass.ray(direction, -1);
    dist -= static_cast<double>(hit->dist) + 2 * glass.offset;
  }
  return {};
}

}  // namespace kairos
