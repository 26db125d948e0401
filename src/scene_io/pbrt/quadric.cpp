#include "scene_io/pbrt/quadric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kairos::pbrt {

namespace {

constexpr std::array<const char*, 6> kKinds{"sphere", "disk", "cylinder", "cone", "paraboloid", "hyperboloid"};

struct Surface {
  Vec3d position, normal;
};

/// A grid of `around` x `along` cells over u and v in [0, 1]; `at(u, v)` gives the surface, its front where u to the
/// right and v up go counter-clockwise.
template <class At>
MeshData grid(int around, int along, const At& at) {
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

int steps(double angle, int of_a_turn) {
  return std::max(1, static_cast<int>(std::ceil(angle / (2 * std::numbers::pi) * of_a_turn - 1e-9)));
}

/// A point turned about the z axis. A whole turn ends exactly where it began.
Vec3d turned(Vec3d p, double u, double phi_max) {
  const double phi = u == 1 && phi_max == 2 * std::numbers::pi ? 0 : u * phi_max;
  return {p.x * std::cos(phi) - p.y * std::sin(phi), p.x * std::sin(phi) + p.y * std::cos(phi), p.z};
}

MeshData sphere(const Quadric& q, int of_a_turn) {
  const double theta_min = std::acos(q.z_min / q.radius), theta_max = std::acos(q.z_max / q.radius);  // from the z axis
  return grid(steps(q.phi_max, of_a_turn), steps(theta_min - theta_max, of_a_turn), [&](double u, double v) {
    const double theta = theta_min + v * (theta_max - theta_min);
    const double sine = theta == std::numbers::pi ? 0 : std::sin(theta);  // the pole is one point
    const Vec3d normal = turned({sine, 0, std::cos(theta)}, u, q.phi_max);
    return Surface{normal * q.radius, normal};
  });
}

/// A curve (distance from the axis, height) that is swept: `at(v)`; `out(v)` is across it, of any length.
template <class At, class Out>
MeshData swept(const Quadric& q, int of_a_turn, int along, const At& at, const Out& out) {
  return grid(steps(q.phi_max, of_a_turn), along, [&](double u, double v) {
    return Surface{turned(at(v), u, q.phi_max), turned(normalize(out(v)), u, q.phi_max)};
  });
}

MeshData hyperboloid(const Quadric& q, int of_a_turn) {
  const Vec3d way = q.to - q.from;
  return swept(
      q, of_a_turn, steps(std::numbers::pi, of_a_turn), [&](double v) { return lerp(q.from, q.to, v); },
      [&](double v) {
        const Vec3d p = lerp(q.from, q.to, v);
        return cross(Vec3d{-p.y, p.x, 0}, way);  // of the ways around and along
      });
}

}  // namespace

bool is_quadric(const std::string& kind) { return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end(); }

double Quadric::widest() const {
  return kind == Kind::hyperboloid ? std::max(std::hypot(from.x, from.y), std::hypot(to.x, to.y)) : radius;
}

double Quadric::reach() const {
  if (kind == Kind::sphere) return radius;
  const double height = std::max({std::abs(z_min), std::abs(z_max), std::abs(from.z), std::abs(to.z)});
  return std::hypot(widest(), height);
}

Quadric read_quadric(const std::string& kind, const Parameters& parameters) {
  Quadric q;
  q.kind = static_cast<Quadric::Kind>(std::find(kKinds.begin(), kKinds.end(), kind) - kKinds.begin());
  const double degrees = std::clamp(parameters.number("phimax", 360), 0.0, 360.0);
  if (degrees == 0) fail(parameters.place(), "'phimax' must be greater than 0");
  q.phi_max = degrees * std::numbers::pi / 180;
  const auto heights = [&](double low, double high, double least, double most) {
    const double a = parameters.number("zmin", low), b = parameters.number("zmax", high);
    q.z_min = std::clamp(std::min(a, b), least, most);
    q.z_max = std::clamp(std::max(a, b), least, most);
    if (q.z_min == q.z_max) fail(parameters.place(), "'zmin' and 'zmax' leave nothing of the " + kind);
  };
  constexpr double kFar = 1e30;  // within float's range
  if (q.kind == Quadric::Kind::hyperboloid) {
    q.from = parameters.vec3("p1", {0, 0, 0});
    q.to = parameters.vec3("p2", {1, 1, 1});
    if (q.from == q.to) fail(parameters.place(), "'p1' and 'p2' of a hyperboloid meet");
    return q;
  }
  q.radius = positive(parameters, "radius", 1);
  switch (q.kind) {
    case Quadric::Kind::sphere:
      heights(-q.radius, q.radius, -q.radius, q.radius);
      break;
    case Quadric::Kind::disk:
      q.inner_radius = parameters.number("innerradius", 0);
      if (q.inner_radius < 0 || q.inner_radius >= q.radius)
        fail(parameters.place(), "'innerradius' must be from 0 to less than 'radius'");
      q.z_min = q.z_max = parameters.number("height", 0);
      break;
    case Quadric::Kind::cylinder:
      heights(-1, 1, -kFar, kFar);
      break;
    case Quadric::Kind::cone:
      q.z_max = positive(parameters, "height", 1);
      break;
    case Quadric::Kind::paraboloid:
      heights(0, 1, 0, kFar);
      break;
    case Quadric::Kind::hyperboloid:
      break;
  }
  return q;
}

int steps_for(double radius_in_pixels) {
  // The middle of a chord lies r (1 - cos(pi / n)), nearly r pi^2 / (2 n^2), inside the circle.
  constexpr double kTolerance = 0.1;
  constexpr std::array kSteps{8, 12, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224};
  const double wanted = std::numbers::pi * std::sqrt(radius_in_pixels / (2 * kTolerance));
  for (const int count : kSteps)
    if (wanted <= count) return count;
  return kMostSteps;
}

MeshData tessellate(const Quadric& q, int of_a_turn) {
  const double height = q.z_max - q.z_min;
  switch (q.kind) {
    case Quadric::Kind::sphere:
      return sphere(q, of_a_turn);
    case Quadric::Kind::disk:
      return swept(
          q, of_a_turn, 1,
          [&](double v) {
            return Vec3d{q.radius + v * (q.inner_radius - q.radius), 0, q.z_max};
          },
          [](double) {
            return Vec3d{0, 0, 1};
          });
    case Quadric::Kind::cylinder:
      return swept(
          q, of_a_turn, 1,
          [&](double v) {
            return Vec3d{q.radius, 0, q.z_min + v * height};
          },
          [](double) {
            return Vec3d{1, 0, 0};
          });
    case Quadric::Kind::cone:
      return swept(
          q, of_a_turn, 1,
          [&](double v) {
            return Vec3d{q.radius * (1 - v), 0, v * height};
          },
          [&](double) {
            return Vec3d{height, 0, q.radius};
          });
    case Quadric::Kind::paraboloid:  // as wide as its radius at the upper edge
      return swept(
          q, of_a_turn, steps(std::numbers::pi, of_a_turn),
          [&](double v) {
            const double z = q.z_min + v * height;
            return Vec3d{q.radius * std::sqrt(z / q.z_max), 0, z};
          },
          [&](double v) {
            const double z = q.z_min + v * height;
            return Vec3d{2 * q.z_max * std::sqrt(z / q.z_max), 0, -q.radius};
          });
    case Quadric::Kind::hyperboloid:
      break;
  }
  return hyperboloid(q, of_a_turn);
}

}  // namespace kairos::pbrt
