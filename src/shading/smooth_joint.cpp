#include "shading/smooth_joint.h"

#include "shading/surface.h"

namespace kairos {

namespace {

// Of normals that count as continuing each other: 30 degrees. Only the noise depends on it, and little: from 5 to 60
// degrees the time for the same error of a kitchen of 1.4 million triangles stays within 10 %.
constexpr double kLeastJointCosine = 0.8660254;

/// Of any length.
bool agree(Vec3d a, Vec3d b) {
  const double cosine = dot(a, b);
  return cosine > 0 && cosine * cosine >= kLeastJointCosine * kLeastJointCosine * dot(a, a) * dot(b, b);
}

bool look_same(const Mesh& mesh, uint32_t a, uint32_t b) {
  if (!mesh.shape().colors.empty() && mesh.shape().colors[a] != mesh.shape().colors[b]) return false;
  for (uint32_t set = 0; set <= mesh.shape().more_uvs.size(); ++set)
    if (const std::vector<Vec2f>& uvs = mesh.uv_set(set); !uvs.empty() && uvs[a] != uvs[b]) return false;
  return true;
}

}  // namespace

bool smooth_joint(const Mesh& mesh, uint32_t a, uint32_t b, float time, const JointNeeds& needs) {
  const Triangle &corners_a = mesh.triangle(a), &corners_b = mesh.triangle(b);
  // A key nearby is near enough: what is in one place, or at an angle, at one end of a key span is so all along, or
  // nearly. Were it not, there would be more noise, not another mean.
  const size_t key = key_position(mesh, time).first;
  const auto face = [&](const Triangle& corners) {
    const Vec3d origin = to_double(mesh.position(key, corners[0]));
    return cross(to_double(mesh.position(key, corners[1])) - origin,
                 to_double(mesh.position(key, corners[2])) - origin);
  };
  const auto goes_on = [&](uint32_t vertex_a, uint32_t vertex_b) {
    if (needs.looks && !look_same(mesh, vertex_a, vertex_b)) return false;
    if (!needs.normals) return true;
    if (mesh.normal_key_count() == 0) return agree(face(corners_a), face(corners_b));
    const size_t normal_key = mesh.normal_key_count() == 1 ? 0 : key;
    return vertex_a == vertex_b ||
           agree(to_double(mesh.normal(normal_key, vertex_a)), to_double(mesh.normal(normal_key, vertex_b)));
  };
  for (const uint32_t vertex_a : corners_a)
    for (const uint32_t vertex_b : corners_b)
      if (vertex_a == vertex_b) return goes_on(vertex_a, vertex_b);
  for (const uint32_t vertex_a : corners_a)
    for (const uint32_t vertex_b : corners_b)
      if (mesh.position(key, vertex_a) == mesh.position(key, vertex_b) && goes_on(vertex_a, vertex_b)) return true;
  return false;
}

}  // namespace kairos
