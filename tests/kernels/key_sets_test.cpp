// Meshes with keys at times of their own: what rays see of them, and that it costs what rays pass, not how many sets of
// key times there are.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

/// The mesh as it stands at `time`.
Mesh still_at(const Mesh& mesh, float time) {
  size_t key = 1;
  while (mesh.key_times[key] < time) ++key;
  const float begin = mesh.key_times[key - 1], end = mesh.key_times[key];
  Mesh still = mesh;
  still.key_times = {0, 1};
  still.positions.resize(2);
  for (size_t v = 0; v < mesh.vertex_count(); ++v)
    still.positions[0][v] = still.positions[1][v] =
        lerp(mesh.positions[key - 1][v], mesh.positions[key][v], (time - begin) / (end - begin));
  return still;
}

/// All meshes as one.
Mesh merged_at(const std::vector<Mesh>& meshes, float time) {
  Mesh all;
  all.key_times = {0, 1};
  all.positions.resize(2);
  for (const Mesh& mesh : meshes) {
    const uint32_t first = static_cast<uint32_t>(all.positions[0].size());
    const Mesh still = still_at(mesh, time);
    for (auto& key : all.positions) key.insert(key.end(), still.positions[0].begin(), still.positions[0].end());
    for (const Triangle& t : mesh.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return all;
}

class KeySets : public testing::TestWithParam<InstructionSet> {};

TEST_P(KeySets, EveryMeshMovesByItsOwnKeys) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  constexpr uint32_t kTriangles = 5;
  size_t instants = 0, agree = 0, packets_agree = 0;
  // Large leaps between keys are split in time; small ones are not.
  for (const float off : {0.02f, 2.0f}) {
    std::vector<Mesh> meshes;
    for (uint32_t keys = 2; keys < 22; ++keys)
      meshes.push_back(
          test::with_random_keys(random, test::random_soup(random, test::Motion::translation, kTriangles), keys, off));
    for (int i = 0; i < 20; ++i) {  // a hundred triangles with the same keys
      meshes.push_back(
          test::with_random_keys(random, test::random_soup(random, test::Motion::translation, kTriangles), 9, off));
      meshes.back().key_times = meshes[20].key_times;
    }
    const Tracer exact(meshes, {Precision::exact, GetParam()}), fast(meshes, {Precision::fast, GetParam()});
    Tracer::Workspace workspace, together;
    constexpr int kInstants = 16;
    const auto time_of = [](int k) { return (static_cast<float>(k) + 0.5f) / kInstants; };
    std::vector<Mesh> standing;  // [instant]
    for (int k = 0; k < kInstants; ++k) standing.push_back(merged_at(meshes, time_of(k)));
    for (int i = 0; i < 40; ++i) {
      const Ray middle = test::random_ray(random);
      std::uniform_real_distribution<float> uniform(-0.02f, 0.02f);
      std::vector<Ray> rays;
      for (int r = 0; r < 5; ++r) {
        const float x = uniform(random), y = uniform(random);
        rays.push_back({middle.origin, middle.direction + Vec3f{x, y, 0}});
      }
      const auto packet = fast.trace_packet(rays, Visibility::visible, together);
      for (size_t r = 0; r < rays.size(); ++r) {
        const auto single = exact.trace(rays[r], Visibility::visible, workspace);
        for (int k = 0; k < kInstants; ++k) {
          const float time = time_of(k);
          const int64_t want = test::nearest_at(standing[static_cast<size_t>(k)], rays[r], time);
          const auto seen_at = [&](std::span<const Segment> segments) {
            for (const Segment& s : segments)
              if (s.begin <= time && time < s.end) return static_cast<int64_t>(s.mesh * kTriangles + s.triangle);
            return int64_t{-1};
          };
          ++instants;
          agree += seen_at(single) == want;
          packets_agree += seen_at(packet[r].segments) == want;
        }
      }
    }
  }
  EXPECT_GE(static_cast<double>(agree), 0.999 * static_cast<double>(instants)) << "seed " << seed;
  EXPECT_GE(static_cast<double>(packets_agree), 0.995 * static_cast<double>(instants)) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, KeySets,
                         testing::ValuesIn(supported_instruction_sets().begin(), supported_instruction_sets().end()),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

/// Triangles in meshes of their own, with keys at the same times or each at its own.
std::vector<Mesh> single_triangles(uint32_t seed, uint32_t count, uint32_t keys, bool same_keys) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Mesh> meshes;
  for (uint32_t i = 0; i < count; ++i) {
    Mesh mesh = test::random_soup(random, test::Motion::translation, 1);
    for (auto& key : mesh.positions)
      for (Vec3f& p : key) p = {p.x * 2, p.y * 2, p.z};
    mesh = test::with_random_keys(random, mesh, keys, 0.1f);
    if (same_keys && i > 0) mesh.key_times = meshes[0].key_times;
    meshes.push_back(mesh);
  }
  return meshes;
}

/// Nodes and triangles met by some rays, in packets of `together`.
uint64_t work(const Tracer& tracer, uint32_t seed, size_t together) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> off(-0.005f, 0.005f);
  Tracer::Workspace workspace;
  for (int i = 0; i < 200; ++i) {
    const Ray middle = test::random_ray(random);
    std::vector<Ray> rays;
    for (size_t r = 0; r < together; ++r) {
      const float x = off(random), y = off(random);
      rays.push_back({middle.origin, middle.direction + Vec3f{x, y, 0}});
    }
    if (together == 1)
      tracer.trace(rays[0], Visibility::visible, workspace);
    else
      tracer.trace_packet(rays, Visibility::visible, workspace);
  }
  return workspace.counters().nodes + workspace.counters().triangles;
}

TEST(KeySets, CostNothingByBeingMany) {
  const uint32_t seed = test::seed();
  for (const uint32_t keys : {3u, 9u}) {
    const Tracer one(single_triangles(seed, 1024, keys, true), {Precision::fast, {}});
    const Tracer many(single_triangles(seed, 1024, keys, false), {Precision::fast, {}});
    EXPECT_LT(many.memory_bytes(), 2 * one.memory_bytes()) << keys << " keys";
    for (const size_t together : {1u, 4u, 16u})
      EXPECT_LT(work(many, seed, together), 2 * work(one, seed, together))
          << keys << " keys, packets of " << together << ", seed " << seed;
  }
}

}  // namespace
}  // namespace kairos
