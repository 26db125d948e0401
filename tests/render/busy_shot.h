// Triangles that hide each other, some of which move.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <random>
#include <utility>

#include <kairos/scene.h>

#include "soup.h"

namespace kairos::test {

/// For each motion a mesh of six triangles in a colour of its own, in front of a background. With `blended` the third
/// mesh is seen through.
inline Shot busy_shot(std::mt19937& random, std::initializer_list<Motion> motions, bool blended, int width,
                      int height) {
  Shot shot;
  for (const Motion motion : motions) {
    Mesh mesh = random_soup(random, motion, 6);
    if (motion == Motion::still) mesh.positions.resize(1);
    mesh.material = static_cast<uint32_t>(shot.meshes.size());
    shot.meshes.push_back(std::move(mesh));
  }
  shot.materials.resize(shot.meshes.size());
  for (size_t m = 0; m < shot.materials.size(); ++m)
    shot.materials[m].base_color = {1.0f / static_cast<float>(m + 1), static_cast<float>(m % 3) / 2, 0.5f};
  if (blended) {
    shot.materials[2].alpha = 0.3f;
    shot.materials[2].alpha_mode = Material::AlphaMode::blend;
  }
  shot.background = {0.2f, 0.4f, 0.1f};
  shot.projection.width = width;
  shot.projection.height = height;
  return shot;
}

}  // namespace kairos::test
