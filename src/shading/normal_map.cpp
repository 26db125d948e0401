#include "shading/normal_map.h"

#include <cmath>

#include "shading/surface.h"

namespace kairos {

namespace {
// The cosine at which a surface is just seen.
constexpr double kLeastCosine = 1e-3;

Vec3d across(Vec3d direction, Vec3d normal) { return normalize(direction - normal * dot(direction, normal)); }
}  // namespace

TangentFrame tangent_frame(Vec3d tangent, float sign, Vec3d normal) {
  const Vec3d right = across(tangent, normal);
  return {right, cross(normal, right) * (sign < 0 ? -1.0 : 1.0)};
}

TangentFrame tangent_frame(const std::array<Vec3d, 3>& vertices, const std::array<Vec2f, 3>& uvs, Vec3d normal) {
  const Vec3d a = vertices[1] - vertices[0], b = vertices[2] - vertices[0];
  const auto change = [&](size_t i) {
    return Vec2d{static_cast<double>(uvs[i].x) - static_cast<double>(uvs[0].x),
                 static_cast<double>(uvs[i].y) - static_cast<double>(uvs[0].y)};
  };
  const Vec2d ua = change(1), ub = change(2);
  const double area = ua.x * ub.y - ua.y * ub.x;
  if (area == 0 || !std::isfinite(area)) return {};
  // v is counted downwards: seen from the front, a picture that is not mirrored has a negative area.
  return tangent_frame((a * ub.y - b * ua.y) * (area < 0 ? -1.0 : 1.0), area < 0 ? 1.0f : -1.0f, normal);
}

Vec4f interpolated_tangent(const Mesh& mesh, uint32_t triangle, const std::array<float, 3>& weights, float time) {
  const KeyPosition key = mesh.tangent_key_count() == 1 ? KeyPosition{} : key_position(mesh, time);
  const Triangle& corners = mesh.triangle(triangle);
  const auto direction = [](const Vec4f& tangent) { return Vec3f{tangent.x, tangent.y, tangent.z}; };
  Vec3f sum{};
  for (size_t i = 0; i < 3; ++i)
    sum += lerp(direction(mesh.tangent(key.first, corners[i])), direction(mesh.tangent(key.second, corners[i])),
                key.weight) *
           weights[i];
  const Vec3f unit = normalize(sum);
  return {unit.x, unit.y, unit.z, mesh.tangent(key.first, corners[0]).w};
}

Vec3d mapped_normal(Vec3f bend, const TangentFrame& frame, Vec3d normal, double seen, Vec3d to_viewer) {
  const Vec3d b = to_double(bend);
  const Vec3d mapped = normalize((frame.right * b.x + frame.up * b.y + normal * b.z) * seen);
  if (mapped == Vec3d{} || frame.right == Vec3d{}) return normal * seen;
  const double cosine = dot(mapped, to_viewer);
  if (cosine >= kLeastCosine) return mapped;
  return normalize(mapped + to_viewer * (kLeastCosine - cosine));
}

}  // namespace kairos
