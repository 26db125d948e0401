// Polygons to triangles.
#pragma once

#include <span>
#include <vector>

#include <kairos/mesh.h>

namespace kairos {

/// Concave polygons with more corners than this become a fan, which may be wrong for them: ear clipping takes time
/// quadratic in the number of corners, and a file may ask for millions.
constexpr size_t kMaxConcaveCorners = 512;

/// Appends the `points.size() - 2` triangles (indices into `points`) of a polygon to `out`, wound as the polygon is;
/// nothing for fewer than three points. Convex polygons, and those without a plane (no area, not finite), become a fan
/// around their first corner; concave ones are cut into ears in their mean plane. A polygon that meets itself gives
/// some triangles, as many as any other. Returns false where a concave polygon was too large and became a fan.
bool triangulate_polygon(std::span<const Vec3f> points, std::vector<Triangle>& out);

}  // namespace kairos
