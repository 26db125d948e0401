// The innermost kernels, each on eight of its objects per call: a ray against a moving node and against a block of
// moving triangles, for every instruction set, beside their scalar references in double.
//
// Half of the boxes and a tenth of the triangles are met, as in the lower levels of a tree.
#include <random>
#include <string>

#include <benchmark/benchmark.h>

#include "kernels/dispatch.h"
#include "kernels/moving_box_test.h"
#include "kernels/moving_triangle.h"

namespace kairos {
namespace {

constexpr size_t kCount = 256;  // fits the first-level cache

struct Input {
  std::vector<Node<kMovingKeys>> nodes;
  std::vector<std::array<BlockKey, 2>> blocks;  // at both ends of a key span
  Ray ray{{0, 0, 0}, {0.1f, 0.2f, -1}};
};

Input make_input() {
  std::mt19937 random(1);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  Input input;
  input.nodes.resize(kCount);
  input.blocks.resize(kCount);
  for (auto& node : input.nodes) {
    node.count = kWidth;
    for (size_t slot = 0; slot < kWidth; ++slot)
      for (size_t axis = 0; axis < 3; ++axis) {
        const float on_ray = (axis == 0 ? 0.1f : axis == 1 ? 0.2f : -1.0f) * 5;
        const float center = on_ray + uniform(-1, 1), move = uniform(-0.5f, 0.5f), half = uniform(0.3f, 0.8f);
        node.lower[0][axis][slot] = center - half;
        node.upper[0][axis][slot] = center + half;
        node.lower[1][axis][slot] = center + move - half;
        node.upper[1][axis][slot] = center + move + half;
      }
  }
  for (auto& block : input.blocks) {
    for (size_t slot = 0; slot < kWidth; ++slot)
      for (size_t axis = 0; axis < 3; ++axis) {
        const float on_ray = (axis == 0 ? 0.1f : axis == 1 ? 0.2f : -1.0f) * 5;
        const float center = on_ray + uniform(-0.5f, 0.5f), move = uniform(-0.3f, 0.3f);
        for (size_t vertex = 0; vertex < 3; ++vertex) {
          const float place = center + uniform(-0.3f, 0.3f);
          block[0].position[vertex][axis][slot] = place;
          block[1].position[vertex][axis][slot] = place + move;
        }
      }
  }
  return input;
}

void moving_node(benchmark::State& state, const Kernels* kernels) {
  const Input input = make_input();
  NodeHits hits;
  for (auto _ : state)
    for (const auto& node : input.nodes) {
      kernels->test_node(node, input.ray, hits);
      benchmark::DoNotOptimize(hits);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kCount * kWidth));
}

void moving_block(benchmark::State& state, const Kernels* kernels) {
  const Input input = make_input();
  BlockHits<float> hits;
  for (auto _ : state)
    for (const auto& block : input.blocks) {
      kernels->test_block(block[0], block[1], input.ray, hits);
      benchmark::DoNotOptimize(hits);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kCount * kWidth));
}

void scalar_box(benchmark::State& state) {
  const Input input = make_input();
  for (auto _ : state)
    for (const auto& node : input.nodes)
      for (size_t slot = 0; slot < kWidth; ++slot) {
        Vec3d lower[2], upper[2];
        for (size_t key = 0; key < 2; ++key)
          for (size_t axis = 0; axis < 3; ++axis) {
            lower[key][static_cast<int>(axis)] = node.lower[key][axis][slot];
            upper[key][static_cast<int>(axis)] = node.upper[key][axis][slot];
          }
        benchmark::DoNotOptimize(
            intersect_moving_box(to_double(input.ray.origin), to_double(input.ray.direction), lower, upper));
      }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kCount * kWidth));
}

void scalar_triangle(benchmark::State& state) {
  const Input input = make_input();
  const RayFrame<double> frame(input.ray);
  for (auto _ : state)
    for (const auto& block : input.blocks)
      for (size_t slot = 0; slot < kWidth; ++slot) {
        std::array<std::array<Vec3f, 3>, 2> position;
        for (size_t key = 0; key < 2; ++key)
          for (size_t vertex = 0; vertex < 3; ++vertex)
            for (size_t axis = 0; axis < 3; ++axis)
              position[key][vertex][static_cast<int>(axis)] = block[key].position[vertex][axis][slot];
        benchmark::DoNotOptimize(intersect_moving_triangle(to_frame(frame, position)));
      }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kCount * kWidth));
}

}  // namespace
}  // namespace kairos

int main(int argc, char** argv) {
  using namespace kairos;
  benchmark::RegisterBenchmark("moving box/reference", scalar_box);
  benchmark::RegisterBenchmark("moving triangle/reference", scalar_triangle);
  for (const InstructionSet set : supported_instruction_sets()) {
    const Kernels* kernels = find_kernels(set);
    if (kernels->test_node == nullptr) continue;
    const std::string name(to_string(set));
    benchmark::RegisterBenchmark(("moving box/" + name).c_str(), moving_node, kernels);
    benchmark::RegisterBenchmark(("moving triangle/" + name).c_str(), moving_block, kernels);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
