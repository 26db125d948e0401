// pbrt's quadrics: surfaces that a line or an arc sweeps while it turns about the z axis.
#pragma once

#include <string>

#include "scene_io/mesh_data.h"
#include "scene_io/pbrt/parameters.h"

namespace kairos::pbrt {

/// Numbers that are not a kind's own are 0, so that equal shapes are equal here.
struct Quadric {
  enum class Kind { sphere, disk, cylinder, cone, paraboloid, hyperboloid };
  Kind kind = Kind::sphere;
  double phi_max = 0;  ///< how far it turns: radians, up to a whole turn
  double radius = 0, inner_radius = 0, z_min = 0, z_max = 0;
  Vec3d from, to;  ///< the line that sweeps a hyperboloid

  friend bool operator==(const Quadric&, const Quadric&) = default;

  double widest() const;  ///< its largest distance from the axis
  double reach() const;   ///< its largest distance from the origin
};

bool is_quadric(const std::string& kind);

/// Reads a Shape statement of such a kind. Throws Error(bad_input) for numbers that make no sense.
Quadric read_quadric(const std::string& kind, const Parameters& parameters);

constexpr int kMostSteps = 256;
constexpr int kUnseenSteps = 128;  ///< what one that is 600 pixels wide needs
/// As many steps for a whole turn as keep the outline within a tenth of a pixel where the widest circle has this radius
/// in pixels; from 8 to kMostSteps, and few different numbers, so that shapes of nearly the same size are shared.
int steps_for(double radius_in_pixels);

/// Its triangles, their fronts and normals outwards (upwards for a disk).
MeshData tessellate(const Quadric& quadric, int steps_of_a_turn);

}  // namespace kairos::pbrt
