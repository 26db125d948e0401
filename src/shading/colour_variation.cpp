#include "shading/colour_variation.h"

#include <array>
#include <cmath>

#include "base/parallel.h"
#include "shading/surface.h"

namespace kairos {

namespace {

constexpr size_t kGrain = 4096;

/// Between two keys normals turn unevenly, most where a triangle is seen to shrink: so many steps are looked at.
constexpr size_t kSteps = 8;

/// A key, or an instant between two.
struct Instant {
  size_t key, next;
  double weight;
  std::array<Vec3d, 3> axes;  // of the shot's space in the world
};

/// The three corners' normals, in the world; three times the triangle's own where the mesh has none.
std::array<Vec3d, 3> corner_normals(const Mesh& mesh, const Triangle& triangle, const Instant& at) {
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

}  // namespace

ColourVariation::ColourVariation(const Shot& shot, const CameraAxes& world_from_camera) : meshes_(shot.meshes.size()) {
  for (size_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    std::vector<Instant> instants{{0, 0, 0, world_from_camera.at(0)}};
    std::vector<double> durations{0};                 // [instant]: since the one before
    const bool turns = mesh.normal_key_count() != 1;  // else the mesh's own normals stay as they are
    for (size_t key = 0; turns && key + 1 < mesh.key_count(); ++key) {
      const double begin = static_cast<double>(mesh.key_times[key]), end = static_cast<double>(mesh.key_times[key + 1]);
      for (size_t step = 1; step <= kSteps; ++step) {
        const double weight = static_cast<double>(step) / kSteps;
        instants.push_back(
            {key, key + 1, weight, world_from_camera.at(static_cast<float>(begin + (end - begin) * weight))});
        durations.push_back((end - begin) / kSteps);
      }
    }
    meshes_[m].resize(mesh.triangle_count());
    parallel_for(mesh.triangle_count(), kGrain, [&](size_t begin, size_t end) {
      for (size_t t = begin; t < end; ++t) {
        double over_area = 0, per_time = 0;
        std::array<Vec3d, 3> before;
        for (size_t k = 0; k < instants.size(); ++k) {
          const std::array<Vec3d, 3> now = corner_normals(mesh, mesh.triangle(t), instants[k]);
          for (size_t i = 0; i < 3; ++i) {
            over_area = std::max(over_area, length(now[i] - now[(i + 1) % 3]));
            if (durations[k] > 0) per_time = std::max(per_time, length(now[i] - before[i]) / durations[k]);
          }
          before = now;
        }
        meshes_[m][t] = {to_units(over_area), to_units(per_time)};
      }
    });
  }
}

}  // namespace kairos
