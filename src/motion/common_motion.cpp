#include "motion/common_motion.h"

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include "camera/pixel_cone.h"
#include "shading/surface.h"

namespace kairos {

namespace {

constexpr int kInstants = 9;
constexpr size_t kVerticesPerMesh = 64;
constexpr double kTolerance = 0.25;  // pixels: more than motion keys leave

}  // namespace

std::optional<double> common_motion(const Shot& shot) {
  const auto moves = [](const auto& light) { return light != nullptr; };
  if (std::any_of(shot.moving_lights.begin(), shot.moving_lights.end(), moves)) return std::nullopt;
  const bool has_local = std::any_of(shot.lights.begin(), shot.lights.end(), [](const Light& light) {
    return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light);
  });
  const auto in_world = [&](Vec3d p, double time) {
    const Vec3d origin = shot.camera_position ? shot.camera_position(time) : Vec3d{};
    if (!shot.world_from_camera) return p + origin;
    const std::array<Vec3d, 3> axes = shot.world_from_camera(time);
    return axes[0] * p.x + axes[1] * p.y + axes[2] * p.z + origin;
  };
  const PixelCone cone(shot.projection);
  std::vector<double> ways;  // in pixels
  for (int i = 1; i < kInstants; ++i) {
    const double time = static_cast<double>(i) / (kInstants - 1);
    std::optional<Vec3d> way;
    if (has_local) way = Vec3d{};
    for (const Mesh& mesh : shot.meshes) {
      const KeyPosition key = key_position(mesh, static_cast<float>(time));
      const size_t count = mesh.vertex_count(), step = std::max<size_t>(1, count / kVerticesPerMesh);
      for (size_t v = 0; v < count; v += step) {
        const auto vertex = static_cast<uint32_t>(v);
        const Vec3d first = to_double(mesh.position(0, vertex));
        const Vec3d now = lerp(to_double(mesh.position(key.first, vertex)),
                               to_double(mesh.position(key.second, vertex)), static_cast<double>(key.weight));
        const Vec3d moved = in_world(now, time) - in_world(first, 0);
        if (!way) way = moved;
        const double width = cone.width_at({0, 0, -length(first)}, {{}, {0, 0, -1}});
        if (!(length(moved - *way) <= kTolerance * width)) return std::nullopt;
        if (i + 1 == kInstants) ways.push_back(width > 0 ? length(now - first) / width : 0);
      }
    }
  }
  if (ways.empty()) return 0;
  const auto middle = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 2);
  std::nth_element(ways.begin(), middle, ways.end());
  return *middle;
}

}  // namespace kairos
