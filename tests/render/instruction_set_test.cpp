// The instruction sets of kernels and of Embree are chosen together, and named in the picture.
#include <algorithm>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <kairos/names.h>
#include <kairos/render.h>

#include "error_matchers.h"
#include "seed.h"

namespace kairos {
namespace {

Shot moving_soup() {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  Shot shot;
  shot.projection.width = 24;
  shot.projection.height = 16;
  shot.materials.emplace_back();
  for (const bool moves : {false, true}) {
    Mesh mesh;
    for (uint32_t t = 0; t < 60; ++t) mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    for (int key = 0; key < (moves ? 2 : 1); ++key) {
      mesh.positions.emplace_back();
      for (size_t v = 0; v < 180; ++v)
        mesh.positions.back().push_back({uniform(random), uniform(random), uniform(random) - 3});
    }
    if (moves) mesh.key_times = {0, 1};
    shot.meshes.push_back(std::move(mesh));
  }
  shot.world_from_camera = [](double) { return std::array<Vec3d, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; };
  shot.camera_position = [](double) { return Vec3d{}; };
  return shot;
}

std::string text_of(const Image& image, const char* name) {
  for (const Attribute& attribute : image.attributes)
    if (attribute.name == name) return std::get<std::string>(attribute.value);
  return "";
}

bool same_bits(const Image& a, const Image& b) {
  for (size_t c = 0; c < a.channels.size(); ++c)
    if (std::memcmp(a.channels[c].values.data(), b.channels[c].values.data(),
                    a.channels[c].values.size() * sizeof(float)))
      return false;
  return true;
}

TEST(InstructionSets, AreChosenForAllRaysAndNamedInThePicture) {
  const Shot shot = moving_soup();
  Renderer renderer(shot);  // which makes Embree's trees anew where the set changes
  for (const IntegratorKind integrator : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed})
    for (const InstructionSet set : supported_instruction_sets()) {
      RenderParams params;
      params.integrator = integrator;
      params.tc_rays = 2;
      params.spp = 8;
      params.instruction_set = set;
      RenderStats stats;
      const Image image = renderer.render(params, &stats);
      EXPECT_TRUE(same_bits(image, render(shot, params))) << to_string(integrator) << ' ' << to_string(set);
      const bool kernels = integrator != IntegratorKind::qmc, embree = integrator != IntegratorKind::tc;
      const InstructionSet least = set == InstructionSet::scalar ? InstructionSet::sse4 : set;
      EXPECT_EQ(text_of(image, "kairos:instruction_set"), kernels ? to_string(set) : "");
      EXPECT_EQ(stats.embree_instruction_set.has_value(), embree);
      if (set != InstructionSet::scalar) {
        EXPECT_EQ(text_of(image, "kairos:embree_instruction_set"), embree ? to_string(least) : "");
      }
    }
}

TEST(InstructionSets, OfDiscreteRaysAreRefusedWhereTheyAreMissing) {
  const Shot shot = moving_soup();
  for (const auto& [name, set] : kNames<InstructionSet>) {
    const auto supported = supported_instruction_sets();
    if (std::find(supported.begin(), supported.end(), set) != supported.end()) continue;
    RenderParams params;
    params.integrator = IntegratorKind::qmc;
    params.instruction_set = set;
    expect_error([&] { render(shot, params); }, {"instruction set", std::string(name)}, ErrorCode::bad_usage);
  }
}

}  // namespace
}  // namespace kairos
