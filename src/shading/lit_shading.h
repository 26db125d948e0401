// How lit surfaces get their colour: the interface of Whitted's shading and of path tracing.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <kairos/render.h>

#include "shading/light_points.h"

namespace kairos {

/// What is wanted of the light that LitShading::resting_light() gives.
enum class RestingLights {
  as_is,              ///< it is one with all other light
  left_out,           ///< it comes from elsewhere
  as_if_none_passed,  ///< its shadows are those of what stands still alone
};

/// What a ray from the camera sees, and how it is to be shaded.
struct ShadingQuery {
  Ray ray;
  uint32_t mesh = 0, triangle = 0;
  float time = 0;    ///< of the shutter
  double width = 0;  ///< of the ray's cone where it meets the triangle
  SampleKey key;
  RestingLights resting = RestingLights::as_is;
  int depth = 0;     ///< mirrors and panes on the ray's way from the camera
  float weight = 1;  ///< the strongest component of what they leave of the light along it
  /// Mirrors and glass there that would leave at least so much are followed by somebody else.
  float followed_elsewhere = std::numeric_limits<float>::infinity();
  /// [mesh]: of these what is followed, if it brings at least kLeastExact, meets what stands still alone. Null: of
  /// none.
  const std::vector<bool>* still_in = nullptr;
};

/// Mirrors that are exact in time are so where they leave at least so much of the light.
inline constexpr float kLeastExact = 1.0f / 16;

/// Where a mirror or glass sends a ray on.
struct FollowedRay {
  Ray ray;
  Vec3f share;   ///< of the light along it, that goes on to the viewer
  double width;  ///< of the ray's cone where it starts
};

/// What a light that stands still brings to a surface that does, if nothing is in its way.
struct RestingLight {
  Ray way;         ///< from the surface to the light
  float dist;      ///< of its end, in lengths of its direction
  Vec3f radiance;  ///< that leaves the surface to the viewer
};

/// What a query sees, where what arrives there is shared by all that see the point.
struct SharedSurface {
  Vec3f own;                       ///< what nobody shares: emission, mirrors, glass, surfaces with narrow highlights
  Vec3f reflects;                  ///< times what is shared, it is the rest of what is seen; zero: there is no rest
  std::array<float, 3> weights{};  ///< of the triangle's vertices
  bool front = false;              ///< the side on which vertices run counter-clockwise is seen
};

/// Safe to use from many threads at once.
class LitShading {
 public:
  virtual ~LitShading() = default;

  /// Light that leaves the triangles towards the rays' origins: one sample of it for each query, whose expectation is
  /// the answer. What is traced on the way are discrete rays at the query's time; those from one pixel to one light go
  /// through the scene together. Both spans of one length. Colours are finite.
  virtual void radiance(std::span<const ShadingQuery> queries, std::span<Vec3f> colours) const = 0;

  /// radiance() in two parts that sum up to it: here what is the query's own. share_asked: does what point, spot and
  /// directional lights bring that are each asked belong to what is shared, and not to what is own?
  virtual void own_light(std::span<const ShadingQuery> queries, bool share_asked,
                         std::span<SharedSurface> surfaces) const = 0;
  /// And what may be shared, with `reflects` as a factor in it. Of queries for which that is not zero.
  virtual void shared_light(std::span<const ShadingQuery> queries, bool share_asked,
                            std::span<Vec3f> colours) const = 0;

  /// Is there anything of that in the scene?
  virtual bool shares_light(bool share_asked) const = 0;

  /// Appends what each of the point, spot and directional lights that are all asked and stand still brings to what a
  /// query sees, but for those that bring nothing.
  virtual void resting_light(const ShadingQuery& query, std::vector<RestingLight>& lights) const = 0;

  /// Of a resting point before a resting camera: is all that leaves it, with the query's key, its own light and that of
  /// lights which rest, along straight ways? Then, at any time, radiance() is `own` and what those of the appended
  /// lights bring that nothing hides. False: it may be more than that.
  virtual bool steady_light([[maybe_unused]] const ShadingQuery& query,
                            [[maybe_unused]] std::vector<RestingLight>& lights, [[maybe_unused]] Vec3f& own) const {
    return false;
  }

  /// Appends the rays that radiance() follows, in mirrors and glass, where a query sees them, whoever follows them.
  virtual void followed_rays([[maybe_unused]] const ShadingQuery& query,
                             [[maybe_unused]] std::vector<FollowedRay>& rays) const {}
  /// What such a ray sees that leaves the scene.
  virtual Vec3f beyond([[maybe_unused]] const Ray& ray, [[maybe_unused]] float time) const { return {}; }
};

}  // namespace kairos
