// The work of a ray, counted exactly: a change that costs work is seen here without a clock.
//
// When a change is meant to alter these numbers, take over what
//     KAIROS_PRINT_COUNTERS=1 build/release/bin/counters_test
// prints for kExpected, and say in the commit what became of the work. The table is the same for all SIMD instruction
// sets: they do the same arithmetic, eight triangles at a time.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "math/hash.h"

namespace kairos {
namespace {

// Scenes are made of hashed integers and of +, -, * alone, so that every machine has the same bits.

/// In [low, high), of any integers.
template <class... Keys>
float uniform(float low, float high, uint64_t first, Keys... rest) {
  return low + (high - low) * unit_float(hash(first, static_cast<uint64_t>(rest)...));
}
Vec3f vector(float size, uint64_t seed, uint64_t index) {
  return {uniform(-size, size, seed, index, 0), uniform(-size, size, seed, index, 1),
          uniform(-size, size, seed, index, 2)};
}

Mesh moving_mesh(size_t keys) {
  Mesh mesh;
  mesh.positions.resize(keys);
  for (size_t k = 0; k < keys; ++k) mesh.key_times.push_back(static_cast<float>(k) / static_cast<float>(keys - 1));
  return mesh;
}

/// A wavy surface of two triangles per cell, seen from the front, that slides and ripples.
Mesh sheet(size_t keys, uint32_t cells, float dist, float move) {
  Mesh mesh = moving_mesh(keys);
  for (uint32_t y = 0; y <= cells; ++y)
    for (uint32_t x = 0; x <= cells; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(cells) - 0.5f;
      const float v = static_cast<float>(y) / static_cast<float>(cells) - 0.5f;
      for (size_t k = 0; k < keys; ++k) {
        const float slide = move * static_cast<float>(k) / static_cast<float>(keys - 1);
        const float ripple = uniform(-0.04f, 0.04f, 1, x, y, k);
        mesh.positions[k].push_back(
            {u * 3 * dist + slide, v * 3 * dist, -dist * (1 + u * u - v * v * 0.5f + ripple) - slide * 0.25f});
      }
    }
  for (uint32_t y = 0; y < cells; ++y)
    for (uint32_t x = 0; x < cells; ++x) {
      const uint32_t a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

/// Triangles of about `size`, each with a motion of its own, some `move` long.
Mesh swarm(uint64_t seed, uint32_t count, float size, float move, float width = 1) {
  Mesh mesh = moving_mesh(2);
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3f center = vector(2, seed, i) + Vec3f{0, 0, -5}, far = vector(move, seed + 1, i);
    for (uint32_t v = 0; v < 3; ++v) {
      Vec3f corner = vector(size, seed + 2, uint64_t{3} * i + v);
      if (v == 2) corner = corner * width;
      mesh.positions[0].push_back(center + corner);
      mesh.positions[1].push_back(center + far + corner + vector(0.2f * size * width, seed + 3, uint64_t{3} * i + v));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

std::vector<Mesh> scene_of(const std::string& name) {
  if (name == "sheet") return {sheet(2, 40, 4, 0.3f)};              // smooth, all of it moves by some triangles' width
  if (name == "leaves") return {swarm(10, 3000, 0.12f, 0.5f)};      // each its own way, many layers
  if (name == "slivers") return {swarm(20, 2000, 0.5f, 2, 0.02f)};  // thin and fast
  // Still walls behind a few things that move, and a sheet over several key spans.
  Mesh wall = sheet(2, 20, 7, 0);
  wall.positions.resize(1);
  wall.key_times.clear();
  return {wall, swarm(30, 200, 0.2f, 0.3f), sheet(5, 12, 6, 0.2f)};
}

constexpr uint32_t kPixels = 24, kRays = 16;

/// The rays of pixel `pixel`: one origin, nearly one direction.
std::array<Ray, kRays> rays_of(uint32_t pixel) {
  constexpr float kWidth = 2.0f / 320;  // of a pixel, at distance 1
  std::array<Ray, kRays> rays;
  const float x = uniform(-0.4f, 0.4f, 100, pixel), y = uniform(-0.4f, 0.4f, 101, pixel);
  for (uint32_t i = 0; i < kRays; ++i)
    rays[i] = {{0, 0, 0}, {x + uniform(0, kWidth, 102, pixel, i), y + uniform(0, kWidth, 103, pixel, i), -1}};
  return rays;
}

/// together: how many rays of a pixel are traced at once; 1: by trace().
TraceCounters count(const std::string& scene, size_t together, InstructionSet set) {
  TracerOptions options;
  options.precision = Precision::fast;
  options.instruction_set = set;
  const Tracer tracer(scene_of(scene), options);
  Tracer::Workspace workspace;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const std::array<Ray, kRays> rays = rays_of(pixel);
    for (size_t i = 0; i < kRays; i += together)
      if (together == 1)
        tracer.trace(rays[i], Visibility::visible, workspace);
      else
        tracer.trace_packet(std::span(rays).subspan(i, together), Visibility::visible, workspace);
  }
  return workspace.counters();
}

/// Sums over kPixels * kRays rays.
struct Expected {
  const char* scene;
  size_t together;
  uint64_t nodes, triangles, root_solves, hits, segments;
};

constexpr Expected kExpected[] = {
    {"sheet", 1, 1454, 3734, 3648, 2770, 1131},         {"sheet", 4, 364, 968, 3558, 2770, 1131},
    {"sheet", 16, 91, 246, 3558, 2770, 1131},           {"leaves", 1, 4953, 52744, 31101, 2948, 3027},
    {"leaves", 4, 1249, 13803, 27399, 2948, 3027},      {"leaves", 16, 313, 3506, 28104, 2948, 3027},
    {"slivers", 1, 12830, 192437, 182496, 12043, 9603}, {"slivers", 4, 3268, 50184, 141144, 12043, 9603},
    {"slivers", 16, 826, 12858, 144825, 12043, 9603},   {"walls", 1, 2975, 13204, 6222, 2899, 906},
    {"walls", 4, 744, 3462, 6198, 2899, 906},           {"walls", 16, 186, 885, 6303, 2899, 906},
};

std::string line_of(const Expected& e, const TraceCounters& c) {
  return fmt::format("    {{\"{}\", {}, {}, {}, {}, {}, {}}},", e.scene, e.together, c.nodes, c.triangles,
                     c.root_solves, c.hits, c.segments);
}

std::vector<InstructionSet> simd_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : supported_instruction_sets())
    if (set != InstructionSet::scalar) sets.push_back(set);
  return sets;
}

TEST(Counters, AreThoseOfTheTable) {
  const std::vector<InstructionSet> sets = simd_sets();
  if (sets.empty()) GTEST_SKIP() << "this machine has no SIMD kernels";
  const bool print = std::getenv("KAIROS_PRINT_COUNTERS") != nullptr;
  for (const Expected& expected : kExpected) {
    if (print) fmt::print("{}\n", line_of(expected, count(expected.scene, expected.together, sets.back())));
    for (const InstructionSet set : sets) {
      const TraceCounters got = count(expected.scene, expected.together, set);
      EXPECT_EQ(got.rays, uint64_t{kPixels} * kRays);
      const TraceCounters wanted{got.rays,      expected.nodes,   expected.triangles, expected.root_solves,
                                 expected.hits, expected.segments};
      // As the table has it, so that what differs can be taken over.
      EXPECT_EQ(line_of(expected, got), line_of(expected, wanted)) << to_string(set);
    }
  }
}

TEST(Counters, AddUpOverRays) {
  // Single rays count the same whatever was traced before them.
  TraceCounters sum;
  TracerOptions options;
  options.precision = Precision::fast;
  const Tracer tracer(scene_of("leaves"), options);
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel)
    for (const Ray& ray : rays_of(pixel)) {
      Tracer::Workspace workspace;
      tracer.trace(ray, Visibility::visible, workspace);
      sum += workspace.counters();
    }
  const TraceCounters whole = count("leaves", 1, tracer.instruction_set());
  EXPECT_EQ(sum.nodes, whole.nodes);
  EXPECT_EQ(sum.root_solves, whole.root_solves);
  EXPECT_EQ(sum.segments, whole.segments);
}

}  // namespace
}  // namespace kairos
