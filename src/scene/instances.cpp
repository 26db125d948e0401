#include "scene/instances.h"

#include <algorithm>

namespace kairos {

std::array<Vec3f, 8> box_corners(const Mesh& mesh) {
  std::array<Vec3f, 8> corners{};
  if (mesh.vertex_count() == 0) return corners;
  Vec3f low = mesh.positions.front().front(), high = low;
  for (const Vec3f& p : mesh.positions.front())
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  for (size_t c = 0; c < corners.size(); ++c)
    corners[c] = {(c & 1) != 0 ? high.x : low.x, (c & 2) != 0 ? high.y : low.y, (c & 4) != 0 ? high.z : low.z};
  return corners;
}

const std::array<Vec3f, 8>& ObjectCorners::of(const Mesh& object) {
  const auto [place, is_new] = known_.try_emplace(&object);
  if (is_new) place->second = box_corners(object);
  return place->second;
}

Mesh expanded(const Mesh& mesh) {
  if (!mesh.object) return mesh;
  Mesh result = *mesh.object;
  result.name = mesh.name;
  result.material = mesh.material;
  result.one_sided = mesh.one_sided;
  result.key_times = mesh.key_times;
  const auto vertices = static_cast<uint32_t>(mesh.vertex_count());
  const auto all_keys = [&](size_t keys, auto& values, const auto& value) {
    values.assign(keys, {});
    for (size_t key = 0; key < keys; ++key)
      for (uint32_t v = 0; v < vertices; ++v) values[key].push_back(value(key, v));
  };
  all_keys(mesh.key_count(), result.positions, [&](size_t key, uint32_t v) { return mesh.position(key, v); });
  all_keys(mesh.normal_key_count(), result.normals, [&](size_t key, uint32_t v) { return mesh.normal(key, v); });
  all_keys(mesh.tangent_key_count(), result.tangents, [&](size_t key, uint32_t v) { return mesh.tangent(key, v); });
  return result;
}

}  // namespace kairos
