#include "shading/colour_variation.h"

#include <cmath>
#include <map>

#include "shading/surface.h"

namespace kairos {

namespace {

/// Between two keys normals turn unevenly, most where a triangle is seen to shrink: so many steps are looked at.
constexpr size_t kSteps = 8;

}  // namespace

/// The three corners' normals, in the world; three times the triangle's own where the mesh has none.
std::array<Vec3d, 3> ColourVariation::corner_normals(const Mesh& mesh, const Triangle& triangle, const Instant& at) {
  const auto between = [&](size_t keys, const auto& value) {
    return lerp(to_double(value(std::min(at.key, keys - 1))), to_double(value(std::min(at.next, keys - 1))), at.weight);
  };
  std::array<Vec3d, 3> corners;
  if (mesh.normal_key_count() != 0) {
    for (size_t i = 0; i < 3; ++i)
      corners[i] =
          normalize(between(mesh.normal_key_count(), [&](size_t key) { return mesh.normal(key, triangle[i]); }));
    return corners;
  }
  for (size_t i = 0; i < 3; ++i)
    corners[i] = between(mesh.key_count(), [&](size_t key) { return mesh.position(key, triangle[i]); });
  const Vec3d n = geometric_normal(corners);
  const Vec3d normal = at.axes[0] * n.x + at.axes[1] * n.y + at.axes[2] * n.z;
  return {normal, normal, normal};
}

ColourVariation::ColourVariation(const Shot& shot, const CameraAxes& world_from_camera)
    : meshes_(&shot.meshes), set_of_(shot.meshes.size()), known_(shot.meshes.size()) {
  const Instant first{0, 0, 0, 0, world_from_camera.at(0)};
  std::map<std::vector<float>, uint32_t> sets;
  for (size_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    known_[m] = std::vector<std::atomic<uint16_t>>(mesh.triangle_count());
    // Else there is nothing that moves, or the mesh's own normals stay as they are.
    const bool turns = mesh.key_count() > 1 && mesh.normal_key_count() != 1;
    const std::vector<float> times = turns ? mesh.key_times : std::vector<float>{};
    const auto [place, is_new] = sets.emplace(times, static_cast<uint32_t>(instants_.size()));
    set_of_[m] = place->second;
    if (!is_new) continue;
    std::vector<Instant>& instants = instants_.emplace_back();
    instants.push_back(first);
    for (size_t key = 0; key + 1 < times.size(); ++key) {
      const double begin = static_cast<double>(times[key]), end = static_cast<double>(times[key + 1]);
      for (size_t step = 1; step <= kSteps; ++step) {
        const double weight = static_cast<double>(step) / kSteps;
        instants.push_back({key, key + 1, weight, (end - begin) / kSteps,
                            world_from_camera.at(static_cast<float>(begin + (end - begin) * weight))});
      }
    }
  }
}

uint16_t ColourVariation::find(uint32_t mesh_index, uint32_t triangle) const {
  const Mesh& mesh = (*meshes_)[mesh_index];
  double over_area = 0, per_time = 0;
  std::array<Vec3d, 3> before;
  for (const Instant& instant : instants_[set_of_[mesh_index]]) {
    const std::array<Vec3d, 3> now = corner_normals(mesh, mesh.triangle(triangle), instant);
    for (size_t i = 0; i < 3; ++i) {
      over_area = std::max(over_area, length(now[i] - now[(i + 1) % 3]));
      if (instant.duration > 0) per_time = std::max(per_time, length(now[i] - before[i]) / instant.duration);
    }
    before = now;
  }
  const auto units = [](double distance, double most) {
    return static_cast<unsigned>(std::min(most, std::ceil(distance / static_cast<double>(kUnit))));
  };
  return static_cast<uint16_t>((units(over_area, kMost / kUnit) + 1) << 8 | units(per_time, 255));
}

}  // namespace kairos
