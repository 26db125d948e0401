// How a point of a surface scatters light, for paths: evenly, by rough borders and as a mirror or clear glass.
#pragma once

#include <array>
#include <optional>

#include "shading/reflectance.h"
#include "shading/surface_point.h"

namespace kairos {

/// A mixture of an even part, facets of the surface's roughness (GGX) that reflect and refract, and facets of a clear
/// coat; docs/method.md, "Paths". Facets below kSmoothest are mirrors: sharp. All directions unit, away from the point.
/// What goes straight on through a thin, smooth wall is no part of it: see straight_share().
class Scattering {
 public:
  /// The point must outlive it. Nothing is scattered where it is not lit.
  explicit Scattering(const SurfacePoint& point);

  /// Of light from `direction`, which part goes to the viewer, times the cosine there. Without what is sharp. From
  /// behind the surface by what is refracted.
  Vec3f value(Vec3d direction) const;
  /// Of sample(), per steradian, without what is sharp.
  double density(Vec3d direction) const;
  // As DirectLight asks for it: every direction may be found by scattering, too.
  double area_density(Vec3d direction) const { return density(direction); }
  double sky_density(Vec3d direction) const { return density(direction); }
  /// Is all of it sharp, or nothing there? Then value() is zero.
  bool is_dark() const { return is_dark_; }
  /// Is nothing of it sharp, and does nothing come from behind the surface?
  bool is_broad() const;
  /// About what it scatters of even light from everywhere.
  Vec3f reflects() const;
  /// Does light from behind the surface count in value()?
  bool lets_through() const { return refracts_ && !facets_sharp_; }

  struct Sample {
    Vec3d direction;
    Vec3f weight;        ///< value / density; of what is sharp, its share by the chance that it was chosen with
    double density = 0;  ///< 0 for what is sharp
    bool is_sharp() const { return density == 0; }
  };
  /// random: uniform in [0, 1)^3. Nothing where light is absorbed, or chance leads into the surface.
  std::optional<Sample> sample(const std::array<float, 3>& random) const;

 private:
  Vec3f reflects(double cosine) const;  // of the facets
  Vec3f refracts(double cosine) const;
  /// Of a facet that reflects or refracts, how often it does the former.
  double reflect_chance(double cosine) const;
  /// The facet by which light from behind is seen, on the viewer's side; zero where none is.
  Vec3d bending_facet(Vec3d direction) const;
  /// side: 1 for what is reflected, -1 for what is let through. Chance may send either to the wrong side, where the
  /// light is hidden by other facets and density() counts only what else goes there.
  std::optional<Sample> rough_sample(Vec3d direction, double side) const;

  const SurfacePoint& point_;
  Boundary boundary_;
  Vec3f even_;
  float metal_, below_ = 1;  // below_: share of light that gets through the clear coat
  // What goes from one facet to another, too, relative to what they send away once: of metal, and of what glass
  // refracts and reflects.
  Vec3f again_{1, 1, 1}, through_again_{1, 1, 1};
  float border_again_ = 1;
  double facets_alpha_, coat_alpha_;
  bool facets_sharp_, coat_sharp_, refracts_, is_dark_;
  double even_chance_ = 0, facets_chance_ = 0;  // of the coat: the rest
};

/// The share of the light from straight behind that a thin, smooth wall lets through to the viewer; zero for what is
/// none.
Vec3f straight_share(const SurfacePoint& point);

}  // namespace kairos
