#include "shading/surface.h"

#include <algorithm>
#include <cmath>

namespace kairos {

KeyPosition key_position(const Mesh& mesh, float time) {
  if (mesh.is_static()) return {};
  const auto& times = mesh.key_times;
  const auto above = static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const size_t second = std::clamp<size_t>(above, 1, times.size() - 1), first = second - 1;
  const float span = times[second] - times[first];
  return {first, second, span > 0 ? std::clamp((time - times[first]) / span, 0.0f, 1.0f) : 1.0f};
}

std::array<Vec3d, 3> triangle_at(const Mesh& mesh, uint32_t triangle, float time) {
  return triangle_at(mesh, triangle, key_position(mesh, time));
}

std::array<Vec3d, 3> triangle_at(const Mesh& mesh, uint32_t triangle, const KeyPosition& key) {
  const Triangle& corners = mesh.triangle(triangle);
  std::array<Vec3d, 3> vertices;
  for (size_t i = 0; i < 3; ++i) {
    const Vec3d first = to_double(mesh.position(key.first, corners[i]));
    vertices[i] = key.first == key.second
                      ? first
                      : lerp(first, to_double(mesh.position(key.second, corners[i])), static_cast<double>(key.weight));
  }
  return vertices;
}

std::array<float, 3> barycentrics(const std::array<Vec3d, 3>& vertices, const Ray& ray) {
  const Vec3d origin = to_double(ray.origin), direction = to_double(ray.direction);
  const Vec3d a = vertices[0] - origin, b = vertices[1] - origin, c = vertices[2] - origin;
  std::array<double, 3> w{dot(direction, cross(b, c)), dot(direction, cross(c, a)), dot(direction, cross(a, b))};
  if (w[0] + w[1] + w[2] < 0)
    for (double& v : w) v = -v;
  for (double& v : w) v = std::max(v, 0.0);
  const double sum = w[0] + w[1] + w[2];
  if (!(sum > 0) || !std::isfinite(sum)) return {1.0f / 3, 1.0f / 3, 1.0f / 3};
  return {static_cast<float>(w[0] / sum), static_cast<float>(w[1] / sum), static_cast<float>(w[2] / sum)};
}

Vec3f interpolated_normal(const Mesh& mesh, uint32_t triangle, const std::array<float, 3>& weights, float time) {
  if (mesh.normal_key_count() == 0) return {};
  const KeyPosition key = mesh.normal_key_count() == 1 ? KeyPosition{} : key_position(mesh, time);
  const Triangle& corners = mesh.triangle(triangle);
  Vec3f normal{};
  for (size_t i = 0; i < 3; ++i) {
    const Vec3f first = mesh.normal(key.first, corners[i]), second = mesh.normal(key.second, corners[i]);
    normal += lerp(first, second, key.weight) * weights[i];
  }
  return normalize(normal);
}

}  // namespace kairos
