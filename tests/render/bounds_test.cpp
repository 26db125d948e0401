// --shading bounds: durations shown are those of the boxes, and never shorter than the truth.
#include <cmath>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/render.h>

#include "whitted_scene.h"

namespace kairos {
namespace {

// Of a picture with one ray per pixel: red where the box is met all the time, blue where only for an instant.
std::vector<double> durations(const Shot& shot, RenderParams params, ShadingKind kind) {
  params.shading = kind;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 1;
  params.aovs = {Aov::coverage};
  const Image image = render(shot, params);
  std::vector<double> result;
  for (size_t i = 0; i < image.find("R")->values.size(); ++i) {
    const float red = image.find("R")->values[i], blue = image.find("B")->values[i];
    const bool met = image.find("coverage.A")->values[i] > 0;
    if (met) {
      EXPECT_NEAR(red + blue, 1, 1e-6);
    }
    result.push_back(met ? static_cast<double>(red) : 0);
  }
  return result;
}

Shot shot_of(std::vector<Mesh> meshes) {
  Shot shot;
  shot.projection.width = 48;
  shot.projection.height = 27;
  shot.materials = {lambert({1, 1, 1})};
  shot.meshes = std::move(meshes);
  return shot;
}

void move(Mesh& mesh, float time, Vec3f by, float grow = 1) {
  if (mesh.key_times.empty()) mesh.key_times = {0};
  mesh.key_times.push_back(time);
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions.back()) p = p * grow + by;
  mesh.normals.resize(std::min<size_t>(mesh.normals.size(), 1));
}

// A box flies by, grows and turns back; a ball crosses its way; a wall stands still.
Shot traffic() {
  std::vector<Mesh> meshes = {box({-2, -0.5f, -6}, {-1, 0.4f, -5}, 0), ball({0, -1.2f, -7}, 0.5f, 8, 0),
                              parallelogram({-9, -9, -12}, {18, 0, 0}, {0, 18, 0}, 0)};
  move(meshes[0], 0.25f, {1, 0.2f, 0.5f}, 1.3f);
  move(meshes[0], 1, {2.2f, 0, 1}, 0.8f);
  move(meshes[1], 1, {0.3f, 3, 2});
  return shot_of(meshes);
}

TEST(Bounds, ComputedIsNeverShorterThanExact) {
  const Shot shot = traffic();
  const std::vector<double> exact = durations(shot, {}, ShadingKind::bounds_exact);
  for (const InstructionSet set : supported_instruction_sets()) {
    RenderParams params;
    params.integrator = IntegratorKind::tc;
    params.instruction_set = set;
    const std::vector<double> computed = durations(shot, params, ShadingKind::bounds);
    size_t met = 0;
    for (size_t i = 0; i < exact.size(); ++i) {
      EXPECT_GE(computed[i], exact[i] - 1e-7) << "beyond the rounding of a colour";
      EXPECT_LE(computed[i], exact[i] + 1e-5) << "and hardly longer";
      met += exact[i] > 0;
    }
    EXPECT_GT(met, exact.size() / 20);
    EXPECT_LT(met, exact.size()) << "what stands still is not shown";
  }
}

// Of a mesh that is its own box, a time-continuous ray sees the triangles for exactly as long.
TEST(Bounds, ExactIsWhatTimeContinuousRaysSeeOfABox) {
  Shot shot = traffic();
  shot.meshes.resize(1);
  const std::vector<double> exact = durations(shot, {}, ShadingKind::bounds_exact);
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 1;
  params.shading = ShadingKind::flat;
  const Image seen = render(shot, params);
  double longest = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(exact[i], seen.find("R")->values[i], 2e-6);
    longest = std::max(longest, exact[i]);
  }
  EXPECT_GT(longest, 0.3);
  EXPECT_LT(longest, 1);
}

TEST(Bounds, TheLongestOfSeveralIsShown) {
  const Shot both = traffic();
  std::vector<std::vector<double>> single;
  for (const size_t which : {0, 1}) single.push_back(durations(shot_of({both.meshes[which]}), {}, ShadingKind::bounds));
  const std::vector<double> together = durations(both, {}, ShadingKind::bounds);
  size_t crossed = 0;
  for (size_t i = 0; i < together.size(); ++i) {
    EXPECT_EQ(together[i], std::max(single[0][i], single[1][i]));
    crossed += single[0][i] > 0 && single[1][i] > 0;
  }
  EXPECT_GT(crossed, 0u);
}

// More key spans than a node has room for; the same path, the same durations.
TEST(Bounds, ManyKeySpansAreOneMotion) {
  std::vector<Mesh> few = {box({-2, -0.5f, -6}, {-1, 0.4f, -5}, 0)}, many = few;
  move(few[0], 1, {2, 0, 0});
  for (int key = 1; key <= 20; ++key)
    move(many[0], static_cast<float>(key) / 20, {0.1f * static_cast<float>(key), 0, 0});
  const std::vector<double> a = durations(shot_of(few), {}, ShadingKind::bounds_exact);
  const std::vector<double> b = durations(shot_of(many), {}, ShadingKind::bounds_exact);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-5);
}

TEST(Bounds, NothingMovesIsBackground) {
  Shot shot = shot_of({parallelogram({-9, -9, -12}, {18, 0, 0}, {0, 18, 0}, 0)});
  shot.background = {0.5f, 0.25f, 2};
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.shading = ShadingKind::bounds;
  const Image image = render(shot, params);
  for (const float value : image.find("B")->values) EXPECT_EQ(value, 2);
}

}  // namespace
}  // namespace kairos
