// Path tracing: light that has been scattered any number of times.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "shading/direct_light.h"
#include "shading/lights.h"
#include "shading/lit_shading.h"
#include "shading/scattering.h"
#include "shading/shadow_rays.h"
#include "shading/surface_point.h"

namespace kairos {

struct PathOptions {
  int max_depth = 8;  ///< how often light may be scattered, mirrored or refracted on its way to the first surface
  float clamp = 0;    ///< the most that it may bring of such light, in any component; 0: no limit
};

/// One path for each shading sample, which looks for lights at each of its points and takes what it meets along its
/// own way, weighed by the balance heuristic: docs/method.md, "Paths".
///
/// Reads the shot, the looks and the sky, which must outlive it.
class Paths : public LitShading {
 public:
  /// scene: made with panes_of(shot).
  Paths(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
        double cone_spread, const PathOptions& options);

  void radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const override;
  void own_light(std::span<const ShadingQuery> queries, bool share_asked,
                 std::span<SharedSurface> surfaces) const override;
  void shared_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<Vec3f> colours) const override;
  bool shares_light(bool /*share_asked*/) const override { return lights_.any(true); }  // what is scattered, too
  void resting_light(const ShadingQuery& query, std::vector<RestingLight>& lights) const override;

 private:
  using Sample = Scattering::Sample;
  struct Sides;

  Vec3f trace(const Ray& ray, const SurfacePoint& first, const Scattering& scatter, Vec3f punctual,
              const SampleInstant& instant, SampleKey key) const;
  /// What point, spot and directional lights bring that are each asked.
  Vec3f punctual_at(const SurfacePoint& point, const Scattering& scatter, const SampleInstant& instant) const;
  /// All other light that is looked for at a point.
  Vec3f found(const SurfacePoint& point, const Scattering& scatter, const SampleInstant& instant, Sides& sides,
              SampleKey key) const;
  /// Does a path that comes to a point go straight on through it? Divides `weight` by the chance.
  static bool passes(const SurfacePoint& point, SampleKey key, Vec3f& weight);
  /// The first point of the ray that the path does not pass; nothing where it leaves the scene or gets lost.
  std::optional<SurfacePoint> next(Ray ray, double width, const SampleInstant& instant, SampleKey key,
                                   Vec3f& weight) const;
  /// Light from where the path leaves the scene or from the surface that it meets, as a share of what is seen of it,
  /// by which it is to be counted beside what is looked for.
  Vec3f from_sky(const Sample& sample, const SampleInstant& instant) const;
  Vec3f from_surface(const Sample& sample, const SurfacePoint& met, const SurfacePoint& from, Sides& sides) const;
  /// The same along a ray that meets the fronts that light meets, where those are not the ones that sight does.
  Vec3f from_light(const Sample& sample, const SurfacePoint& from, const SampleInstant& instant, Sides& sides) const;

  SurfacePoints points_;
  Lights lights_;
  ShadowRays shadows_;
  DirectLight<Scattering> direct_;
  double cone_spread_;
  PathOptions options_;
  bool has_one_sided_;  // so that sight and light may meet different things
};

}  // namespace kairos
