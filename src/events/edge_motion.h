// The edge that passes a ray when it sees another surface: which way it faces in the picture, how fast it moves, and
// exactly when it is there.
#pragma once

#include <optional>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "camera/film_plane.h"

namespace kairos {

struct EdgeMotion {
  double time = 0;     ///< shutter time at which the edge passes the film point
  Vec2d normal{1, 0};  ///< unit, in pixels right and down: the way in which it moves
  double speed = 0;    ///< pixels per shutter time along the normal; above 0
};

/// A point of a surface that a ray sees.
struct SurfacePoint {
  double depth = 0;  ///< along the view axis, in camera space
  Vec2d flow{};      ///< of the material, pixels right and down per shutter time
};

/// Looks at the triangles of a shot in camera space, which must outlive it. Safe to use from many threads.
class EdgeFinder {
 public:
  explicit EdgeFinder(const Shot& shot) : shot_(shot), plane_(shot.projection) {}

  /// before, after: what the ray through a film point sees until `time` and from there on; the mesh kNoMesh: nothing.
  /// The edge of the nearer one, or else the line in which one passes through the other. Unset where neither is near:
  /// what changed was no outline (a cut-out, the border of the picture's time) or does not move.
  std::optional<EdgeMotion> find(double x, double y, double time, const Segment& before, const Segment& after) const;
  /// Is what is seen from then on nearer than what was seen before?
  static bool arrives(const Segment& before, const Segment& after);

  /// Where the ray through a film point meets the triangle of `seen`, which it sees at shutter time `time`.
  SurfacePoint point(double x, double y, double time, const Segment& seen) const;

 private:
  const Shot& shot_;
  FilmPlane plane_;
};

}  // namespace kairos
