// Sphere, disk and cylinder as triangles.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene_io/pbrt/geometry.h"

namespace kairos::pbrt {

namespace {

// Steps for a whole turn. The outline of a sphere then lies 0.03 % of its radius inside the true one: less than a tenth
// of a pixel for a sphere 600 pixels wide.
constexpr int kStepsAround = 128;

struct Surface {
  Vec3d position, normal;
};

/// A grid of `around` x `along` cells over u and v in [0, 1]; `at(u, v)` gives the surface, its front where u to the
/// right and v up go counter-clockwise.
template <class At>
MeshData tessellate(int around, int along, const At& at) {
  MeshData data;
  data.positions.resize(1);
  data.normals.resize(1);
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i <= around; ++i) {
      const double u = static_cast<double>(i) / around, v = static_cast<double>(j) / along;
      const Surface surface = at(u, v);
      data.positions[0].push_back(to_float(surface.position));
      data.normals[0].push_back(to_float(surface.normal));
      data.uvs.push_back({static_cast<float>(u), static_cast<float>(v)});
    }
  const auto& p = data.positions[0];
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {  // not the flat ones at a pole
    if (p[a] != p[b] && p[b] != p[c] && p[c] != p[a]) data.triangles.push_back({a, b, c});
  };
  const auto row = static_cast<uint32_t>(around + 1);
  for (uint32_t j = 0; j < static_cast<uint32_t>(along); ++j)
    for (uint32_t i = 0; i < static_cast<uint32_t>(around); ++i) {
      const uint32_t corner = j * row + i;
      add(corner, corner + 1, corner + row + 1);
      add(corner, corner + row + 1, corner + row);
    }
  return data;
}

double positive(const Parameters& parameters, const char* name, double otherwise) {
  const double value = parameters.number(name, otherwise);
  if (!(value > 0)) fail(parameters.place(), std::string("'") + name + "' must be greater than 0");
  return value;
}

double angle_max(const Parameters& parameters) {
  const double degrees = std::clamp(parameters.number("phimax", 360), 0.0, 360.0);
  if (degrees == 0) fail(parameters.place(), "'phimax' must be greater than 0");
  return degrees * std::numbers::pi / 180;
}

int steps(double angle) {
  return std::max(1, static_cast<int>(std::ceil(angle / (2 * std::numbers::pi) * kStepsAround)));
}

/// Unit vector around z. A whole turn ends exactly where it began.
Vec3d around_z(double u, double phi_max) {
  const double phi = u == 1 && phi_max == 2 * std::numbers::pi ? 0 : u * phi_max;
  return {std::cos(phi), std::sin(phi), 0};
}

}  // namespace

MeshData tessellate_sphere(const Parameters& parameters) {
  const double radius = positive(parameters, "radius", 1), phi_max = angle_max(parameters);
  const double z0 = parameters.number("zmin", -radius), z1 = parameters.number("zmax", radius);
  const double z_min = std::clamp(std::min(z0, z1), -radius, radius);
  const double z_max = std::clamp(std::max(z0, z1), -radius, radius);
  if (z_min == z_max) fail(parameters.place(), "'zmin' and 'zmax' leave nothing of the sphere");
  const double theta_min = std::acos(z_min / radius), theta_max = std::acos(z_max / radius);  // from the z axis
  return tessellate(steps(phi_max), steps(theta_min - theta_max), [&](double u, double v) {
    const double theta = theta_min + v * (theta_max - theta_min);
    const double sine = theta == std::numbers::pi ? 0 : std::sin(theta);  // the pole is one point
    const Vec3d normal = around_z(u, phi_max) * sine + Vec3d{0, 0, std::cos(theta)};
    return Surface{normal * radius, normal};
  });
}

MeshData tessellate_disk(const Parameters& parameters) {
  const double radius = positive(parameters, "radius", 1), phi_max = angle_max(parameters);
  const double inner = parameters.number("innerradius", 0), height = parameters.number("height", 0);
  if (inner < 0 || inner >= radius) fail(parameters.place(), "'innerradius' must be from 0 to less than 'radius'");
  return tessellate(steps(phi_max), 1, [&](double u, double v) {
    const Vec3d edge = around_z(u, phi_max) * (radius + v * (inner - radius));
    return Surface{edge + Vec3d{0, 0, height}, {0, 0, 1}};
  });
}

MeshData tessellate_cylinder(const Parameters& parameters) {
  const double radius = positive(parameters, "radius", 1), phi_max = angle_max(parameters);
  const double z0 = parameters.number("zmin", -1), z1 = parameters.number("zmax", 1);
  if (z0 == z1) fail(parameters.place(), "'zmin' and 'zmax' leave nothing of the cylinder");
  const double z_min = std::min(z0, z1), z_max = std::max(z0, z1);
  return tessellate(steps(phi_max), 1, [&](double u, double v) {
    const Vec3d normal = around_z(u, phi_max);
    return Surface{normal * radius + Vec3d{0, 0, z_min + v * (z_max - z_min)}, normal};
  });
}

}  // namespace kairos::pbrt
