#include "policy/shadow_prices.h"

#include <algorithm>
#include <variant>

namespace kairos {

namespace {

constexpr double kShadeTime = 355;  // of a sample without light; see shadow_prices.h
/// A path takes so many times as long as light that arrives straight (kitchen, 320x180: 15.8 against 4.1 s).
constexpr double kPathLength = 4;
constexpr int kMostAsked = 16;  // of point and spot lights: of more, one is chosen

}  // namespace

double lit_sample_time(const Shot& shot, ShadingKind shading) {
  int few = 0, rays = 0;
  for (const Light& light : shot.lights) {
    if (std::holds_alternative<DirectionalLight>(light) || std::holds_alternative<ConstantLight>(light))
      ++rays;
    else if (std::holds_alternative<EnvironmentLight>(light))
      rays += 2;  // one by brightness, one by how the surface scatters
    else
      ++few;
  }
  rays += few > kMostAsked ? 1 : few;
  const bool glows = std::any_of(shot.meshes.begin(), shot.meshes.end(), [&](const Mesh& mesh) {
    return mesh.material < shot.materials.size() && shot.materials[mesh.material].emission != Vec3f{};
  });
  rays += glows ? 1 : 0;
  return (kShadeTime + kLightRayTime * rays) * (shading == ShadingKind::path ? kPathLength : 1);
}

double weighing_time(const Shot& shot) {
  constexpr double kWeighing = 250;
  constexpr size_t kMostWeighed = 64;  // of more, a tree is asked
  size_t glowing = 0;
  for (const Mesh& mesh : shot.meshes)
    if (mesh.material < shot.materials.size() && shot.materials[mesh.material].emission != Vec3f{})
      glowing += mesh.triangle_count();
  return kWeighing * static_cast<double>(std::min(glowing, kMostWeighed));
}

}  // namespace kairos
