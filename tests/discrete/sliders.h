/// Triangles that slide along x, and the rays that meet them.
#pragma once

#include <utility>
#include <vector>

#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos {

/// A triangle in the plane z = `depth` around (x, 0), counter-clockwise seen from +z: 1 wide at y = 0, up to y = 1.
inline std::vector<Vec3f> triangle_at(float x, float depth) {
  return {{x - 0.5f, -1, depth}, {x + 0.5f, -1, depth}, {x, 1, depth}};
}

/// A triangle that is at xs[k] at time times[k].
inline Mesh make_slider(std::vector<float> times, const std::vector<float>& xs, float depth) {
  Mesh mesh;
  mesh.name = "slider";
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = std::move(times);
  for (float x : xs) mesh.positions.push_back(triangle_at(x, depth));
  return mesh;
}

/// At y = 0 the triangle is half a unit wide: it covers the ray at x where |x - its place| < 1/4.
constexpr float kReach = 0.25f;
inline Ray ray_at(float x) { return {{x, 0, 5}, {0, 0, -2}}; }

}  // namespace kairos
