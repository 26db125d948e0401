// pbrt's curves as triangles: ribbons and tubes along cubic Bézier segments.
#pragma once

#include <optional>
#include <vector>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/screen.h"

namespace kairos::pbrt {

struct CurveSegment {
  std::array<Vec3d, 4> points;  ///< of a cubic Bézier curve
  double width0, width1;        ///< at its ends, from edge to edge
  Vec3d normal0, normal1;       ///< of a ribbon, at its ends; unit
};

struct Curve {
  enum class Kind {
    flat,      ///< turned towards whoever looks
    ribbon,    ///< with normals of its own
    cylinder,  ///< round
  };
  Kind kind = Kind::flat;
  std::vector<CurveSegment> segments;
};

/// Reads a Shape "curve" of any basis and degree that pbrt has. Throws Error(bad_input).
Curve read_curve(const Parameters& parameters);

/// Where curves are seen from, for a number of pieces that no pixel shows.
struct CurveView {
  const Screen& screen;
  const TransformPath& world_from_shape;
};

/// Appends a curve's triangles. A flat one becomes a ribbon that faces the eye when the shutter is half open; without a
/// view it is a tube, as round ones are. Appends nothing for a segment that is a point.
void add_curve(const Curve& curve, const std::optional<CurveView>& view, std::vector<Triangle>& triangles,
               std::vector<Vec2f>& uvs, Vertices& vertices);

}  // namespace kairos::pbrt
