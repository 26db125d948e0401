#include "scene/studio.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "image/texture.h"

namespace kairos {

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// Directions of one look around, spread evenly (R. Swinbank and R. Purser 2006: a spiral by the golden ratio).
constexpr size_t kDirections = 64;

/// Component by component, so that a compiler can take several at a time.
struct Directions {
  std::array<float, kDirections> x{}, y{}, z{};

  Directions() {
    for (size_t i = 0; i < kDirections; ++i) {
      const double height = 1 - (2 * static_cast<double>(i) + 1) / kDirections;
      const double turn = 2 * std::numbers::pi * static_cast<double>(i) / std::numbers::phi;
      const double across = std::sqrt(1 - height * height);
      x[i] = static_cast<float>(across * std::cos(turn));
      y[i] = static_cast<float>(height);
      z[i] = static_cast<float>(across * std::sin(turn));
    }
  }
};

using Distances = std::array<float, kDirections>;  // infinite: open

/// Light from afar in one of the directions reaches the origin if it does not pass between the three planes through the
/// origin and two corners each.
void block(const std::array<Vec3f, 3>& v, bool one_sided, const Directions& along, Distances& nearest) {
  const std::array<Vec3f, 3> planes{cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])};
  const float volume = dot(v[0], planes[0]);  // positive: the origin sees its back, and light from outside its front
  if (volume == 0 || (one_sided && volume < 0)) return;
  const float side = volume < 0 ? -1.0f : 1.0f;
  for (size_t i = 0; i < kDirections; ++i) {
    const auto beside = [&](const Vec3f& plane) {
      return side * (plane.x * along.x[i] + plane.y * along.y[i] + plane.z * along.z[i]);
    };
    const float a = beside(planes[0]), b = beside(planes[1]), c = beside(planes[2]), sum = a + b + c;
    const bool inside = a >= 0 && b >= 0 && c >= 0 && sum > 0;
    const float dist = side * volume / sum;
    nearest[i] = inside && dist < nearest[i] ? dist : nearest[i];
  }
}

bool stops_light(const Shot& shot, const Mesh& mesh) {
  if (mesh.material >= shot.materials.size()) return true;
  const Material& material = shot.materials[mesh.material];
  return material.alpha_mode == Material::AlphaMode::opaque && !(material.transmission > 0);
}

/// A soft light of the studio: as bright as `radiance` in its middle, fading like a bell.
struct SoftLight {
  Vec3d towards;  // unit
  double radius;  // radians, of the bell's standard deviation
  double radiance;
};

// Above neutral grey all round, brighter upwards, stand a large light where the key light is, a wider and weaker one
// opposite to it, and one above and behind what is looked at, for its outline. x: to the camera's right, y: up, z:
// towards the camera.
constexpr double kFloor = 0.13, kHorizon = 0.28, kZenith = 0.43;
const std::array<SoftLight, 3> kSoftLights{SoftLight{normalize(Vec3d{-0.5, 0.7, 1}), 0.28, 1.3},
                                           SoftLight{normalize(Vec3d{1, 0.35, 0.45}), 0.42, 0.5},
                                           SoftLight{normalize(Vec3d{0.25, 1, -0.55}), 0.32, 0.9}};
// Irradiance of the key light on what faces it; with the environment's, white that faces the camera is about as bright
// as white.
constexpr float kKey = 1.86f;
const Vec3d kKeyTravels = -kSoftLights[0].towards;

double studio_radiance(Vec3d d) {
  const double height = d.y < 0 ? -std::sqrt(-d.y) : std::sqrt(d.y);  // the horizon is narrow
  double radiance = d.y < 0 ? kHorizon + (kFloor - kHorizon) * -height : kHorizon + (kZenith - kHorizon) * height;
  for (const SoftLight& light : kSoftLights) {
    const double angle = std::acos(std::clamp(dot(d, light.towards), -1.0, 1.0)) / light.radius;
    radiance += light.radiance * std::exp(-angle * angle / 2);
  }
  return radiance;
}

std::shared_ptr<const Texture> studio_picture() {
  constexpr int kHeight = 64, kWidth = 2 * kHeight;
  Pixels pixels;
  pixels.width = kWidth;
  pixels.height = kHeight;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const double longitude = ((column + 0.5) / kWidth - 0.5) * 2 * std::numbers::pi;
      const double polar = (row + 0.5) / kHeight * std::numbers::pi;
      const Vec3d d{std::sin(polar) * std::sin(longitude), std::cos(polar), -std::sin(polar) * std::cos(longitude)};
      const auto radiance = static_cast<float>(studio_radiance(d));
      pixels.values.insert(pixels.values.end(), {radiance, radiance, radiance, 1});
    }
  return std::make_shared<const Texture>(std::move(pixels), Texture::Encoding::linear);
}

/// Axes with y up in the world and x as near as can be to a camera's right.
std::array<Vec3d, 3> upright(const Mat4& world_from_camera) {
  constexpr Vec3d kUp{0, 1, 0};
  Vec3d right = transform_vector(world_from_camera, {1, 0, 0});
  right.y = 0;
  right = normalize(right);
  if (right == Vec3d{}) right = {1, 0, 0};  // a camera on its side
  return {right, kUp, cross(right, kUp)};
}

}  // namespace

Surroundings look_around(const Shot& shot, Vec3d eye) {
  const Directions directions;
  Distances nearest;
  nearest.fill(kFar);
  constexpr size_t kTrianglesAtOnce = 1 << 14;
  for (const Mesh& mesh : shot.meshes) {
    if (mesh.key_count() == 0 || !stops_light(shot, mesh)) continue;
    std::vector<Distances> pieces((mesh.triangle_count() + kTrianglesAtOnce - 1) / kTrianglesAtOnce);
    parallel_for(pieces.size(), 1, [&](size_t begin, size_t end) {
      for (size_t piece = begin; piece < end; ++piece) {
        pieces[piece].fill(kFar);
        const size_t last = std::min((piece + 1) * kTrianglesAtOnce, mesh.triangle_count());
        for (size_t t = piece * kTrianglesAtOnce; t < last; ++t) {
          std::array<Vec3f, 3> corners;
          for (size_t i = 0; i < 3; ++i) corners[i] = to_float(to_double(mesh.position(0, mesh.triangle(t)[i])) - eye);
          block(corners, mesh.one_sided, directions, pieces[piece]);
        }
      }
    });
    for (const Distances& piece : pieces)
      for (size_t i = 0; i < kDirections; ++i) nearest[i] = std::min(nearest[i], piece[i]);
  }
  const auto met = static_cast<size_t>(
      std::partition(nearest.begin(), nearest.end(), [](float d) { return d < kFar; }) - nearest.begin());
  Surroundings around;
  around.open = 1 - static_cast<double>(met) / kDirections;
  if (met == 0) return around;
  std::nth_element(nearest.begin(), nearest.begin() + met / 2, nearest.begin() + met);
  around.distance = static_cast<double>(nearest[met / 2]);
  return around;
}

bool reflects_light(const Shot& shot) {
  return std::any_of(shot.meshes.begin(), shot.meshes.end(), [&](const Mesh& mesh) {
    if (mesh.triangle_count() == 0) return false;
    if (mesh.material >= shot.materials.size()) return true;
    const Material& m = shot.materials[mesh.material];
    if (m.unlit) return false;
    return m.base_color != Vec3f{} || m.clearcoat > 0 || m.metallic > 0 || m.roughness < 1 || m.transmission > 0;
  });
}

void add_studio(Shot& shot, const Mat4& world_from_camera, const Surroundings& around, bool environment) {
  const std::array<Vec3d, 3> axes = upright(world_from_camera);
  if (environment) {
    shot.lights.push_back(EnvironmentLight{"", {1, 1, 1}, EnvironmentLight::Mapping::latitude_longitude, axes});
    shot.light_textures.resize(shot.lights.size());
    shot.light_textures.back() = studio_picture();
  }
  const Vec3f white{1, 1, 1};
  if (around.open >= kLeastOpen) {
    const Vec3d travels = axes[0] * kKeyTravels.x + axes[1] * kKeyTravels.y + axes[2] * kKeyTravels.z;
    shot.lights.push_back(DirectionalLight{to_float(travels), white * kKey});
    return;
  }
  // Walls at the median distance that face it get a little more than they would get of the studio, since what is seen
  // lies farther away than the median.
  constexpr double kAll = 4;
  const auto intensity = static_cast<float>(kAll * around.distance * around.distance);
  const auto at = [eye = shot.camera_position, intensity](double time) -> Light {
    return PointLight{eye ? to_float(eye(time)) : Vec3f{}, Vec3f{1, 1, 1} * intensity};
  };
  shot.lights.push_back(at(0));
  if (!shot.camera_moves) return;
  shot.moving_lights.resize(shot.lights.size());
  shot.moving_lights.back() = at;
}

}  // namespace kairos
