// Whitted's recursive shading: direct light with shadows, mirrors, glass.
#pragma once

#include <memory>

#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "shading/light_points.h"
#include "shading/lights.h"
#include "shading/looks.h"

namespace kairos {

/// Reads the shot, the looks and the sky, which must outlive it. Safe to use from many threads at once.
class Whitted {
 public:
  Whitted(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
          double cone_spread, int max_depth);

  /// Light that leaves the triangle towards the ray's origin. Shadow, reflected and refracted rays are discrete, at
  /// `time`. width: of the ray's cone where it meets the triangle.
  Vec3f radiance(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double width, SampleKey key) const;

 private:
  struct Instant;  // what all rays of one shading sample have in common
  struct Point;

  Point point_at(const Ray& ray, uint32_t mesh, uint32_t triangle, double width, const Instant& instant) const;
  /// The point's normal as the mesh's normal picture bends it.
  Vec3d bent_normal(const Point& point, uint32_t mesh, uint32_t triangle, const std::array<Vec3d, 3>& vertices,
                    const std::array<float, 3>& weights, const Instant& instant) const;
  Vec3f shade(const Ray& ray, const Point& point, const Instant& instant, SampleKey key, int depth, float weight) const;
  Vec3f direct(const Point& point, const Instant& instant, SampleKey key) const;
  Vec3f from_sky(const Point& point, const Instant& instant, SampleKey key) const;
  Vec3f from(const Ray& ray, double width, const Instant& instant, SampleKey key, int depth, float weight) const;
  /// Which part of the light gets through to the point from the side that it is seen from.
  Vec3f transmittance(const Point& point, Vec3d direction, double dist, const Instant& instant) const;

  const Shot& shot_;
  const Looks& looks_;
  Lights lights_;
  std::shared_ptr<const DiscreteScene> scene_;
  double cone_spread_;
  int max_depth_;
};

}  // namespace kairos
