// A point of a surface as one shading sample sees it: all that light which arrives there has to know.
#pragma once

#include <array>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "shading/camera_axes.h"
#include "shading/lights.h"
#include "shading/looks.h"

namespace kairos {

/// What all rays of one shading sample have in common.
struct SampleInstant {
  float time = 0;  ///< of the shutter
  Place place;
};

struct SurfacePoint {
  const Material* material = nullptr;
  Look look;
  uint32_t mesh = 0, triangle = 0;
  Vec3d position, to_viewer;       ///< in the shot's space
  Vec3d face;                      ///< the triangle's normal, unit, on the viewer's side; zero: it has no area
  Vec3d normal;                    ///< the interpolated one, bent by the normal picture, on the viewer's side
  bool entering = false;           ///< the viewer is on the side that faces outwards
  std::array<float, 3> weights{};  ///< of the triangle's vertices
  double offset = 0;               ///< by which rays start off the surface
  double width = 0;                ///< of the cone of sight

  double side_of(Vec3d direction) const { return dot(face, direction) >= 0 ? 1 : -1; }
  /// The start of a ray on the viewer's side (side 1) or on the other (-1).
  Ray ray(Vec3d direction, double side) const {
    return {to_float(position + face * (side * offset)), to_float(direction)};
  }
};

/// Reads the shot and the looks, which must outlive it. Safe to use from many threads at once.
class SurfacePoints {
 public:
  SurfacePoints(const Shot& shot, const Looks& looks);

  SampleInstant instant(float time) const;
  /// In which the ray meets the triangle. width: of the ray's cone there.
  SurfacePoint at(const Ray& ray, uint32_t mesh, uint32_t triangle, double width, const SampleInstant& instant) const;

 private:
  /// The point's normal as the mesh's normal picture bends it.
  Vec3d bent_normal(const SurfacePoint& point, const std::array<Vec3d, 3>& vertices,
                    const std::array<float, 3>& weights, const SampleInstant& instant) const;

  const Shot& shot_;
  const Looks& looks_;
  CameraAxes world_from_camera_;
  bool has_local_lights_;  // which ask where the camera is
};

}  // namespace kairos
