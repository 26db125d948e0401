// The colour of what a ray sees at an instant.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <kairos/render.h>

#include "camera/pixel_cone.h"
#include "discrete/discrete_scene.h"
#include "shading/camera_axes.h"
#include "shading/colour_variation.h"
#include "shading/cut_outs.h"
#include "shading/light_points.h"
#include "shading/lit_shading.h"
#include "shading/looks.h"
#include "shading/sky.h"

namespace kairos {

struct Shade {
  Vec3f colour;  ///< linear, scene-referred
  Vec3f normal;  ///< unit, world space; zero where undefined, or when nothing asked for it
  Vec3f albedo;
};

/// On the straight line from one to another. share: 0 to 1, of the way.
inline Shade lerp(const Shade& a, const Shade& b, float share) {
  const Vec3f normal = lerp(a.normal, b.normal, share);
  const float length = std::sqrt(dot(normal, normal));
  return {lerp(a.colour, b.colour, share), length > 0 ? normal / length : Vec3f{}, lerp(a.albedo, b.albedo, share)};
}

/// Reads the shot, which must outlive it. Safe to use from many threads at once.
class Shader {
 public:
  /// want_normal: fill Shade::normal even where the colour does not need it. discrete: discrete rays on the shot, for
  /// lit shading; null: it makes them itself. max_depth, clamp: see RenderParams. want_variation: of normals too, which
  /// takes a look at all of them.
  Shader(const Shot& shot, ShadingKind kind, bool want_normal, int max_depth = 8,
         std::shared_ptr<const DiscreteScene> discrete = nullptr, bool want_variation = false, float clamp = 0);

  /// time: shutter time at which the ray sees the triangle. key: only lit shading asks.
  Shade shade(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, SampleKey key = {}) const;
  /// The same for several, which is cheaper for those of one pixel. Both spans of one length; widths are filled in.
  void shade(std::span<ShadingQuery> queries, std::span<Shade> shades) const;

  /// Of lit pictures, what shade() gives in two parts; see LitShading. `limited` is not yet applied. Queries have their
  /// widths.
  void own_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<SharedSurface> surfaces) const {
    lit_->own_light(queries, share_asked, surfaces);
  }
  void shared_light(std::span<const ShadingQuery> queries, bool share_asked, std::span<Vec3f> colours) const {
    lit_->shared_light(queries, share_asked, colours);
  }

  bool shares_light(bool share_asked) const { return lit_ != nullptr && lit_->shares_light(share_asked); }

  /// The same but for the colour of what is lit.
  Shade surface(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
    double width = 0;
    return shade_unlit(ray, mesh, triangle, time, width);
  }
  /// What stands for the colour of what is lit where its edges matter and its light does not: without noise.
  Vec3f unlit_colour(const ShadingQuery& query) const;
  bool is_lit() const { return lit_ != nullptr; }

  /// Of a lit picture: see LitShading. The query's width is filled in.
  void resting_light(ShadingQuery& query, std::vector<RestingLight>& lights) const;
  /// The same of LitShading::steady_light. base: what surface() gives, with the surface's own light for its colour.
  bool steady_light(ShadingQuery& query, std::vector<RestingLight>& lights, Shade& base) const;
  /// Of a lit picture: see LitShading. Queries have their widths.
  const LitShading& lit() const { return *lit_; }
  /// [mesh]: mirrors and glass that rest before a camera that does, so that what they show lies along fixed rays: in
  /// Whitted's shading, where nothing is blended.
  std::vector<bool> resting_mirrors() const;
  /// Of a ray's cone that goes on from a mirror, where it is `dist` farther.
  double width_beyond(double width, float dist) const { return width + cone_.spread() * static_cast<double>(dist); }
  /// [mesh]: where resting_light() may be part of what is seen: opaque things that rest before a camera that does, in a
  /// lit scene in which all that hides anything hides all of it, from both sides.
  std::vector<bool> resting_receivers() const;
  const Shot& shot() const { return shot_; }
  /// As pictures limit what rays bring.
  Vec3f limited(Vec3f colour) const { return shot_.limited(colour); }

  /// False when all instants at which a ray sees one of the mesh's triangles look the same.
  bool varies(uint32_t mesh) const { return varies_[mesh]; }

  /// How much the colours of one of the mesh's triangles may differ, over all of it and `duration` of shutter time: 0
  /// where they don't, kMuch and more where it is worth sampling often. An estimate, to spend samples by.
  float variation(uint32_t mesh, uint32_t triangle, float duration) const {
    if (!is_even_[mesh] || (want_normal_ && variation_.empty())) return kMuch;
    return want_normal_ ? variation_.of(mesh, triangle, duration) : 0;
  }
  static constexpr float kMuch = 1;

  /// Is what is seen of the mesh, looked at straight, mostly what lies elsewhere: in a mirror, or behind glass?
  bool shows_others(uint32_t mesh) const { return shows_others_[mesh]; }

  /// For two visibility segments of a ray, of which the second begins when the first ends: true when its colour goes on
  /// without a jump, so that what is seen of both may be shaded as one.
  bool joined(const Segment& first, const Segment& second) const;

  /// Of a camera ray's cone, `dist` along the ray in lengths of its direction.
  double width_at(float dist) const { return cone_.width_at(dist); }

  /// How much of what is behind a blended surface it hides. See CutOuts.
  float opacity(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
    return cut_outs_ ? cut_outs_->opacity(ray, mesh, triangle, time) : 1;
  }

  /// What a camera ray sees that leaves the scene: the shot's backdrop or else its background and, unless normals are
  /// shown, pictures of the environment.
  Vec3f sky(const Ray& ray, float time) const;
  /// Are pictures seen?
  bool has_sky() const { return kind_ != ShadingKind::normal && !shot_.backdrop && !sky_->empty(); }
  bool sky_varies() const { return has_sky() && shot_.camera_moves; }  ///< may it look different at other instants?

  /// Where surfaces are missing or blended: for everything that traces rays through the shot. Null for nowhere.
  const std::shared_ptr<const AlphaCutOuts>& cut_outs() const { return cut_outs_; }

 private:
  Vec3f normal(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;
  /// Does the side that a ray sees emit what its material does?
  bool shines(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;
  Look look(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double& width) const;
  /// All but the colour of lit surfaces. width: of the ray's cone.
  Shade shade_unlit(const Ray& ray, uint32_t mesh, uint32_t triangle, float time, double& width) const;

  const Shot& shot_;
  std::unique_ptr<const Looks> looks_;  // which lit_ points to
  std::unique_ptr<const Sky> sky_;
  PixelCone cone_;
  CameraAxes world_from_camera_;
  std::shared_ptr<const AlphaCutOuts> cut_outs_;
  std::unique_ptr<const LitShading> lit_;  // where it is wanted
  std::vector<bool> varies_;               // [mesh]
  std::vector<bool> is_even_;              // [mesh]: nothing makes a difference, or nothing but normals
  std::vector<bool> shows_others_;         // [mesh]
  ColourVariation variation_;              // of these
  ShadingKind kind_;
  bool want_normal_;
};

}  // namespace kairos
