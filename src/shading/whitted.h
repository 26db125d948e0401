// Whitted's recursive shading: direct light with shadows, mirrors, glass.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "discrete/discrete_scene.h"
#include "shading/direct_light.h"
#include "shading/lights.h"
#include "shading/lit_shading.h"
#include "shading/looks.h"
#include "shading/reflectance.h"
#include "shading/shadow_rays.h"
#include "shading/surface_point.h"

namespace kairos {

/// Reads the shot, the looks and the sky, which must outlive it.
class Whitted : public LitShading {
 public:
  /// scene: made with panes_of(shot).
  Whitted(const Shot& shot, const Looks& looks, const Sky& sky, std::shared_ptr<const DiscreteScene> scene,
          double cone_spread, int max_depth);

  void radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const override;
  void own_light(std::span<const ShadingQuery> queries, bool share_asked,
                 std::span<SharedSurface> surfaces) const override;
  void shared_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<Vec3f> colours) const override;
  bool shares_light(bool share_asked) const override { return lights_.any(share_asked); }
  void resting_light(const ShadingQuery& query, std::vector<RestingLight>& lights) const override;
  bool steady_light(const ShadingQuery& query, std::vector<RestingLight>& lights, Vec3f& own) const override;
  void followed_rays(const ShadingQuery& query, std::vector<FollowedRay>& rays) const override;
  Vec3f beyond(const Ray& ray, float time) const override;

 private:
  /// The balance of light at a point, as DirectLight wants it.
  class Scatter {
   public:
    explicit Scatter(const SurfacePoint& point);
    const Reflectance& shares() const { return shares_; }
    Vec3f value(Vec3d direction) const;
    double area_density(Vec3d direction) const { return is_sharp_ ? density(direction) : 0; }
    double sky_density(Vec3d direction) const { return density(direction); }
    bool is_dark() const { return is_dark_; }
    /// Is the highlight so narrow and strong that it is looked for by scattering, too?
    bool is_sharp() const { return is_sharp_; }
    /// Is it so narrow that what is seen in it changes from pixel to pixel?
    bool is_narrow() const { return is_sharp_ && shares_.alpha < kNarrow; }
    Vec3d direction(const std::array<float, 3>& sample) const;

   private:
    /// Of a highlight that is a few degrees wide.
    static constexpr double kNarrow = 0.05;

    double density(Vec3d direction) const;

    Vec3d normal_, face_, to_viewer_;
    Reflectance shares_;
    double by_cosine_;
    bool is_dark_, is_sharp_;
  };

  /// How a ray came to a point: see ShadingQuery.
  struct Past {
    int depth = 0;
    float weight = 1, followed_elsewhere = std::numeric_limits<float>::infinity();
    const std::vector<bool>* still_in = nullptr;
  };
  static Past past_of(const ShadingQuery& query) {
    return {query.depth, query.weight, query.followed_elsewhere, query.still_in};
  }

  Vec3f shade(const Ray& ray, const SurfacePoint& point, const SampleInstant& instant, SampleKey key,
              const Past& past) const;
  /// What comes of the point itself, with what punctual lights give, and by mirrors and glass.
  Vec3f shade(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, Vec3f punctual,
              const SampleInstant& instant, SampleKey key, const Past& past) const;
  /// By mirrors and glass alone.
  Vec3f followed(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                 SampleKey key, const Past& past) const;
  /// Calls follow(share, ray, what is left of the light, branch of the key) for what is worth it.
  template <class Follow>
  void visit_followed(const Ray& ray, const SurfacePoint& point, const Scatter& scatter, const Past& past,
                      const Follow& follow) const;
  Vec3f by_chance(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant, SampleKey key) const;
  /// But for by_scattering(). arrive: see DirectLight.
  template <class Arrive>
  Vec3f by_choice(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                  AreaLights::View& view, SampleKey key, const Arrive& arrive) const;
  Vec3f by_scattering(const SurfacePoint& point, const Scatter& scatter, const SampleInstant& instant,
                      AreaLights::View& view, SampleKey key) const;
  /// Does it look for emissive meshes?
  bool meets_areas(const Scatter& scatter) const { return scatter.is_sharp() && !lights_.areas().empty(); }
  /// What is met of the layer, lit as ever.
  Vec3f from(const Ray& ray, double width, const SampleInstant& instant, SampleKey key, const Past& past,
             DiscreteLayer layer) const;

  SurfacePoints points_;
  Lights lights_;
  ShadowRays shadows_;
  DirectLight<Scatter> direct_;
  double cone_spread_;
  int max_depth_;
};

}  // namespace kairos
