// A point of a moving triangle, as a ray sees it at an instant.
#pragma once

#include <kairos/mesh.h>
#include <kairos/tracer.h>

namespace kairos {

/// Where a mesh is between its keys: keys `first` and `second` with weights 1 - weight and weight.
struct KeyPosition {
  size_t first = 0, second = 0;
  float weight = 0;
};
/// time: shutter time, 0 to 1. At a jump: the key after it.
KeyPosition key_position(const Mesh& mesh, float time);

/// The triangle's vertices at `time`.
std::array<Vec3d, 3> triangle_at(const Mesh& mesh, uint32_t triangle, float time);
std::array<Vec3d, 3> triangle_at(const Mesh& mesh, uint32_t triangle, const KeyPosition& key);

/// Weights of the three vertices, 0 to 1 each, sum 1, of the point in which the ray meets the triangle's plane. Outside
/// of the triangle (by the rounding of a segment's ends) they are clamped to it; seen edge on, they are all equal.
std::array<float, 3> barycentrics(const std::array<Vec3d, 3>& vertices, const Ray& ray);

/// The point with these weights.
inline Vec3d point_of(const std::array<Vec3d, 3>& vertices, const std::array<float, 3>& weights) {
  return vertices[0] * static_cast<double>(weights[0]) + vertices[1] * static_cast<double>(weights[1]) +
         vertices[2] * static_cast<double>(weights[2]);
}

/// The mesh's own normal, interpolated over time and over the triangle: unit; zero when they cancel or are missing.
Vec3f interpolated_normal(const Mesh& mesh, uint32_t triangle, const std::array<float, 3>& weights, float time);

/// Unit normal of the side on which the vertices run counter-clockwise; zero for a triangle without area.
inline Vec3d geometric_normal(const std::array<Vec3d, 3>& v) { return normalize(cross(v[1] - v[0], v[2] - v[0])); }

}  // namespace kairos
