// Random moving triangles in front of the origin, and what a ray sees of them by brute force.
#pragma once

#include <algorithm>
#include <random>

#include <kairos/tracer.h>

#include "seed.h"

namespace kairos::test {

enum class Motion { translation, deform, violent, slow, still, sliver, turn, through_origin };
inline constexpr Motion kAllMotions[] = {Motion::translation, Motion::deform, Motion::violent, Motion::slow,
                                         Motion::still,       Motion::sliver, Motion::turn,    Motion::through_origin};

inline Mesh random_soup(std::mt19937& random, Motion motion, uint32_t count) {
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  const auto vector = [&](float size) {
    const float x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return Vec3f{x, y, z};
  };
  Mesh mesh;
  mesh.name = "soup";
  mesh.positions.resize(2);
  mesh.key_times = {0, 1};
  for (uint32_t i = 0; i < count; ++i) {
    Vec3f center = vector(2);
    center.z = uniform(-12, -4);
    if (motion == Motion::through_origin) center.z += 8;
    const float size = motion == Motion::sliver ? 2 : uniform(0.3f, 1.5f);
    Vec3f p[3], q[3];
    for (auto& v : p) v = center + vector(size);
    if (motion == Motion::sliver) p[2] = p[0] + (p[1] - p[0]) * 0.5f + vector(0.02f);
    const Vec3f move = motion == Motion::slow             ? vector(0.02f)
                       : motion == Motion::through_origin ? vector(5)
                                                          : vector(3);
    for (size_t v = 0; v < 3; ++v) {
      q[v] = p[v] + move;
      if (motion == Motion::deform) q[v] += vector(size);
      if (motion == Motion::violent) q[v] = p[v] + vector(4);
      if (motion == Motion::slow) q[v] += vector(0.01f);
      if (motion == Motion::still) q[v] = p[v];
      if (motion == Motion::turn) q[v] = p[(v + 1) % 3] + vector(0.2f);
    }
    for (size_t v = 0; v < 3; ++v) {
      mesh.positions[0].push_back(p[v]);
      mesh.positions[1].push_back(q[v]);
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// The same motion with `count` keys at random times, off it by up to `off` in all of them but the first and last.
inline Mesh with_random_keys(std::mt19937& random, const Mesh& mesh, uint32_t count, float off = 1) {
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  Mesh result = mesh;
  result.key_times = {0};
  for (uint32_t key = 1; key + 1 < count; ++key) result.key_times.push_back(uniform(0.01f, 0.99f));
  result.key_times.push_back(1);
  std::sort(result.key_times.begin(), result.key_times.end());
  result.positions.resize(count);
  for (uint32_t key = 0; key < count; ++key) {
    const float time = result.key_times[key];
    result.positions[key].clear();
    const bool inner = key > 0 && key + 1 < count;
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
      Vec3f p = lerp(mesh.positions.front()[v], mesh.positions.back()[v], time);
      if (inner)
        for (int axis = 0; axis < 3; ++axis) p[axis] += uniform(-off, off);
      result.positions[key].push_back(p);
    }
  }
  return result;
}

inline Ray random_ray(std::mt19937& random) {
  const auto uniform = [&](float size) { return std::uniform_real_distribution<float>(-size, size)(random); };
  const float ox = uniform(0.5f), oy = uniform(0.5f), oz = uniform(0.5f), dx = uniform(0.4f), dy = uniform(0.4f);
  return {{ox, oy, oz}, {dx, dy, -1}};
}

inline std::vector<Vec3f> positions_at(const Mesh& mesh, float time) {
  std::vector<Vec3f> positions;
  for (size_t v = 0; v < mesh.vertex_count(); ++v)
    positions.push_back(lerp(mesh.positions[0][v], mesh.positions[1][v], time));
  return positions;
}

/// The triangle of the segment that holds `time`; -1 for none.
inline int64_t triangle_at(std::span<const Segment> segments, float time) {
  for (const Segment& s : segments)
    if (s.begin <= time && time < s.end) return s.triangle;
  return -1;
}

/// The nearest triangle of a mesh of one key span, by Moeller and Trumbore's test in double on the moved vertices.
inline int64_t nearest_at(const Mesh& mesh, const Ray& ray, float time) {
  int64_t nearest = -1;
  double nearest_dist = INFINITY;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    Vec3d p[3];
    for (size_t v = 0; v < 3; ++v) {
      const uint32_t index = mesh.triangles[i][v];
      p[v] = lerp(to_double(mesh.positions[0][index]), to_double(mesh.positions[1][index]), double(time));
    }
    const Vec3d o = to_double(ray.origin), d = to_double(ray.direction), e1 = p[1] - p[0], e2 = p[2] - p[0];
    const Vec3d h = cross(d, e2);
    const double det = dot(e1, h);
    if (det == 0) continue;
    const Vec3d s = o - p[0], q = cross(s, e1);
    const double u = dot(s, h) / det, v = dot(d, q) / det, dist = dot(e2, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && dist > 0 && dist < nearest_dist) {
      nearest_dist = dist;
      nearest = static_cast<int64_t>(i);
    }
  }
  return nearest;
}

}  // namespace kairos::test
