// A floor, and what a ray sees in Whitted's shading: for what is computed by hand.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "discrete/discrete_scene.h"
#include "shading/shader.h"
#include "shading/shadow_rays.h"
#include "whitted_scene.h"

namespace kairos::test {

/// What the ray sees, in the mean over `samples` shading samples.
inline Vec3f seen(const Shot& shot, const Ray& ray, uint32_t samples = 1, int max_depth = 8, float time = 0.5f) {
  const auto scene =
      std::make_shared<const DiscreteScene>(shot.meshes, DiscreteOptions{true, nullptr, 0, panes_of(shot)});
  const Shader shader(shot, ShadingKind::whitted, false, max_depth, scene);
  const auto hit = scene->intersect(ray, time);
  if (!hit) {
    ADD_FAILURE() << "the ray sees nothing";
    return {};
  }
  Vec3d sum;
  for (uint32_t i = 0; i < samples; ++i)
    sum += to_double(shader.shade(ray, hit->mesh, hit->triangle, time, {7, i}).colour);
  return to_float(sum / static_cast<double>(samples));
}

inline const Mesh kFloor = parallelogram({-10, -1, 10}, {20, 0, 0}, {0, 0, -20}, 0);  // y = -1, facing up

inline Shot floor_shot(Vec3f colour = {0.5f, 0.25f, 1}) {
  Shot shot;
  shot.meshes = {kFloor};
  shot.materials = {lambert(colour)};
  return shot;
}

inline const Ray kDown{{0, 0, 0}, {1, -1, -2}};  // meets the floor at (1, -1, -2)

inline void expect_near(Vec3f actual, Vec3f expected, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << "component " << c;
}

}  // namespace kairos::test
