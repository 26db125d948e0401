// Whitted's recursive shading: direct light with shadows, mirrors, glass.
#pragma once

#include <memory>
#include <span>

#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "shading/direct_light.h"
#include "shading/light_points.h"
#include "shading/lights.h"
#include "shading/looks.h"
#include "shading/reflectance.h"
#include "shading/shadow_rays.h"
#include "shading/surface_point.h"

namespace kairos {

/// What a ray from the camera sees, and how it is to be shaded.
struct ShadingQuery {
  Ray ray;
  uint32_t mesh = 0, triangle = 0;
  float time = 0;    ///< of the shutter
  double width = 0;  ///< of the ray's cone where it meets the triangle
  SampleKey key;
};

/// Reads the shot, the looks and the sky, which must outlive it. Safe to use from many threads at once.
class Whitted {
 public:
  /// scene: made with panes_of(shot).
  Whitted(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
          double cone_spread, int max_depth);

  /// Light that leaves the triangles towards the rays' origins. Shadow, reflected and refracted rays are discrete, at
  /// the query's time; those from one pixel to one light go through the scene together. Both spans of one length.
  void radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const;
  Vec3f radiance(const ShadingQuery& query) const;

 private:
  /// The balance of light at a point, as DirectLight wants it.
  class Scatter {
   public:
    Scatter(const SurfacePoint& point, const Reflectance& shares);
    Vec3f value(Vec3d direction) const;
    double area_density(Vec3d direction) const { return is_sharp_ ? density(direction) : 0; }
    double sky_density(Vec3d direction) const { return density(direction); }
    bool is_dark() const { return is_dark_; }
    /// Is the highlight so narrow and strong that it is looked for by scattering, too?
    bool is_sharp() const { return is_sharp_; }
    Vec3d direction(const std::array<float, 3>& sample) const;

   private:
    double density(Vec3d direction) const;

    Vec3d normal_, face_, to_viewer_;
    Vec3f diffuse_, highlight_;
    double alpha_, by_cosine_;
    bool is_dark_, is_sharp_;
  };

  Vec3f shade(const Ray& ray, const SurfacePoint& point, const SampleInstant& instant, SampleKey key, int depth,
              float weight) const;
  /// What comes of the point itself, with what punctual lights give, and by mirrors and glass.
  Vec3f shade(const Ray& ray, const SurfacePoint& point, const Reflectance& shares, const Scatter& scatter,
              Vec3f punctual, const SampleInstant& instant, SampleKey key, int depth, float weight) const;
  Vec3f by_chance(const SurfacePoint& point, const Reflectance& shares, const Scatter& scatter,
                  const SampleInstant& instant, SampleKey key) const;
  Vec3f by_scattering(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                      AreaLights::View& view, SampleKey key) const;
  Vec3f from(const Ray& ray, double width, const SampleInstant& instant, SampleKey key, int depth, float weight) const;

  SurfacePoints points_;
  Lights lights_;
  ShadowRays shadows_;
  DirectLight<Scatter> direct_;
  double cone_spread_;
  int max_depth_;
};

}  // namespace kairos
