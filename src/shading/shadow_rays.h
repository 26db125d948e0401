// What gets through between a surface and a light.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <kairos/scene.h>

#include "discrete/discrete_scene.h"
#include "shading/surface_point.h"

namespace kairos {

/// [mesh]: lets light through, as DiscreteOptions asks.
std::vector<bool> panes_of(const Shot& shot);

/// How light goes through glass on a shadow ray's way.
enum class Glass {
  straight,  ///< straight through all of it
  bends,     ///< through what bends or scatters it not at all: such light must be found another way
};

/// What a straight ray meets beyond panes.
struct BeyondPanes {
  std::optional<DiscreteHit> hit;  ///< none: it leaves the scene. dist: from the point it started at
  Vec3f open;                      ///< which part of the light from there comes through
};

/// Discrete rays that go straight on through glass and lose what its faces reflect and absorb. Reads the shot, the
/// looks and the points, which must outlive it. Safe to use from many threads at once.
class ShadowRays {
 public:
  /// scene: made with panes_of(shot).
  ShadowRays(const Looks& looks, const SurfacePoints& points, std::shared_ptr<const DiscreteScene> scene)
      : looks_(looks), points_(points), scene_(std::move(scene)) {}

  /// A ray with an end.
  struct Way {
    Ray ray;
    double dist;  ///< to look along it, in lengths of its direction
  };
  /// From the point to where something lies, `dist` along `direction`; the ray starts a little off the surface.
  static Way way_from(const SurfacePoint& point, Vec3d direction, double dist);

  /// Which part of the light gets through to the point. dist: of the light.
  Vec3f open(const SurfacePoint& point, Vec3d direction, double dist, const SampleInstant& instant,
             Glass glass = Glass::straight) const;

  struct Query {
    const SurfacePoint* point;
    const SampleInstant* instant;
    Vec3d direction;
    double dist;                               ///< not above 0: nobody asks, and nothing gets through
    DiscreteLayer layer = DiscreteLayer::all;  ///< that may be in the way; of panes, all are
  };
  /// The same for several, to one light at most: rays that go about the same way go through the scene together.
  void open(std::span<const Query> queries, std::span<Vec3f> result) const;

  /// The first thing that is no pane. Nothing if it is dark behind too many of them.
  std::optional<BeyondPanes> look(const SurfacePoint& point, Vec3d direction, const SampleInstant& instant,
                                  Glass glass = Glass::straight) const;

  const DiscreteScene& scene() const { return *scene_; }

 private:
  Vec3f through_panes(Way way, double width, const SampleInstant& instant, Glass glass = Glass::straight) const;
  /// Of light that comes through a face of glass, straight.
  Vec3f through(const SurfacePoint& glass) const;

  const Looks& looks_;
  const SurfacePoints& points_;
  std::shared_ptr<const DiscreteScene> scene_;
};

}  // namespace kairos
