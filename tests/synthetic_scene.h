// Scenes whose motion is given by functions, for tests that know what the answer is.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace kairos {

/// Vertices that move as path(vertex, scene time, side) says.
struct PathMotion : VertexMotion {
  using Path = std::function<Vec3d(size_t vertex, double time, Side side)>;

  size_t vertices = 0;
  Path path;
  std::vector<double> all_kinks;
  bool still = false, linear = false;
  std::function<Vec3f(size_t vertex, double time)> normal;

  size_t vertex_count() const override { return vertices; }
  bool has_normals() const override { return static_cast<bool>(normal); }
  bool is_static(double, double) const override { return still; }
  bool is_linear_between_kinks() const override { return linear; }
  std::vector<double> kinks(double open, double close) const override {
    std::vector<double> inside;
    for (double k : all_kinks)
      if (open < k && k < close) inside.push_back(k);
    return inside;
  }
  void positions(double time, Side side, std::span<Vec3d> out) const override {
    for (size_t v = 0; v < out.size(); ++v) out[v] = path(v, time, side);
  }
  void normals(double time, Side, std::span<Vec3f> out) const override {
    for (size_t v = 0; v < out.size(); ++v) out[v] = normal(v, time);
  }
};

struct CameraMotion : TransformMotion {
  std::function<Mat4(double time)> placement = [](double) { return Mat4{}; };
  std::vector<double> all_kinks;
  bool still = true;

  bool is_static(double, double) const override { return still; }
  std::vector<double> kinks(double, double) const override { return all_kinks; }
  Mat4 at(double time, Side) const override { return placement(time); }
};

/// `points` vertices on the path, as consecutive triangles (0 1 2), (3 4 5), ...
inline SceneMesh make_path_mesh(size_t points, PathMotion::Path path) {
  auto motion = std::make_shared<PathMotion>();
  motion->vertices = points;
  motion->path = std::move(path);
  SceneMesh mesh;
  mesh.name = "mesh";
  for (uint32_t v = 0; v + 2 < points; v += 3) mesh.triangles.edit().push_back({v, v + 1, v + 2});
  mesh.motion = motion;
  return mesh;
}
inline PathMotion& motion_of(SceneMesh& mesh) {
  return const_cast<PathMotion&>(static_cast<const PathMotion&>(*mesh.motion));
}

/// One mesh, a shutter from 0 to 1, and a camera at the origin that looks along -z.
inline Scene make_scene(SceneMesh mesh) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  SceneCamera camera;
  camera.name = "main";
  camera.motion = std::make_shared<CameraMotion>();
  scene.cameras.push_back(camera);
  scene.shutter = {0, 1};
  return scene;
}
inline CameraMotion& camera_motion_of(Scene& scene) {
  return const_cast<CameraMotion&>(static_cast<const CameraMotion&>(*scene.cameras[0].motion));
}

/// Turns by `angle` radians about y.
inline Mat4 turned(double angle) { return rotation({0, std::sin(angle / 2), 0, std::cos(angle / 2)}); }

/// Linear motion between a mesh's keys, after a jump on the jump's instant.
inline Vec3d position_at(const Mesh& mesh, size_t vertex, double time) {
  if (mesh.is_static()) return to_double(mesh.positions[0][vertex]);
  const auto& times = mesh.key_times;
  size_t k = 0;
  while (k + 2 < times.size() && time >= static_cast<double>(times[k + 1])) ++k;
  const double begin = times[k], end = times[k + 1];
  const double weight = end > begin ? (time - begin) / (end - begin) : 1;
  return lerp(to_double(mesh.positions[k][vertex]), to_double(mesh.positions[k + 1][vertex]), weight);
}

/// Pixel coordinates of a point in camera space; its depth must be positive.
inline Vec2d project(const Projection& projection, Vec3d p) {
  const double width = projection.width, height = projection.height;
  if (projection.orthographic) {
    const double scale = height / projection.view_height;
    return {width / 2 + p.x * scale, height / 2 - p.y * scale};
  }
  const double scale = height / 2 / std::tan(projection.vfov / 2) / -p.z;
  return {width / 2 + p.x * scale, height / 2 - p.y * scale};
}

}  // namespace kairos
