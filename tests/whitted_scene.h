// Small lit scenes in camera space, for tests.
#pragma once

#include <cmath>

#include <kairos/render.h>

namespace kairos {

/// A parallelogram: corner, and two sides; it faces cross(side_u, side_v).
inline Mesh parallelogram(Vec3f corner, Vec3f side_u, Vec3f side_v, uint32_t material) {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.positions = {{corner, corner + side_u, corner + side_u + side_v, corner + side_v}};
  mesh.material = material;
  return mesh;
}

/// An axis-aligned box, faces outwards.
inline Mesh box(Vec3f low, Vec3f high, uint32_t material) {
  Mesh mesh;
  mesh.positions.resize(1);
  for (int i = 0; i < 8; ++i)
    mesh.positions[0].push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  mesh.material = material;
  return mesh;
}

/// A ball of 2 * rings * rings triangles with its own smooth normals.
inline Mesh ball(Vec3f centre, float radius, int rings, uint32_t material) {
  Mesh mesh;
  mesh.positions.resize(1);
  mesh.normals.resize(1);
  const int columns = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int c = 0; c <= columns; ++c) {
      const double polar = M_PI * r / rings, turn = 2 * M_PI * (c % columns) / columns;
      const Vec3f n =
          r == 0 ? Vec3f{0, 1, 0}
          : r == rings
              ? Vec3f{0, -1, 0}
              : to_float({std::sin(polar) * std::sin(turn), std::cos(polar), std::sin(polar) * std::cos(turn)});
      mesh.positions[0].push_back(centre + n * radius);
      mesh.normals[0].push_back(n);
    }
  for (int r = 0; r < rings; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto a = static_cast<uint32_t>(r * (columns + 1) + c), below = a + static_cast<uint32_t>(columns) + 1;
      if (r + 1 < rings) mesh.triangles.push_back({a, below, below + 1});
      if (r > 0) mesh.triangles.push_back({a, below + 1, a + 1});
    }
  mesh.material = material;
  return mesh;
}

inline Material lambert(Vec3f colour) {
  Material material;
  material.base_color = colour;
  return material;
}
inline Material mirror(Vec3f colour) {
  Material material = lambert(colour);
  material.metallic = 1;
  material.roughness = 0;
  return material;
}
inline Material glass(float ior) {
  Material material = lambert({1, 1, 1});
  material.transmission = 1;
  material.roughness = 0;
  material.ior = ior;
  return material;
}
inline Material lamp(Vec3f emission) {
  Material material = lambert({0, 0, 0});
  material.emission = emission;
  return material;
}

}  // namespace kairos
