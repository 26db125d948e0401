#include "discrete/key_stretches.h"

#include <algorithm>
#include <map>

namespace kairos {

namespace {

/// How many sets of key times may have Embree scenes of their own, through each of which every ray goes; all others
/// share one. Embree intersects its own triangles up to twice as fast as it asks others to.
constexpr size_t kOwnSets = 4;

}  // namespace

Stretches stretches_of(const Mesh& mesh) {
  Stretches stretches;
  for (const UniformRun& run : uniform_runs(mesh.key_times))
    stretches.emplace_back(mesh.key_times[run.first], mesh.key_times[run.last]);
  return stretches;
}

std::vector<Stretches> choose_own_sets(std::span<const Mesh> meshes) {
  std::map<Stretches, size_t> triangles;
  for (const Mesh& mesh : meshes)
    if (!mesh.is_static()) triangles[stretches_of(mesh)] += mesh.triangle_count();
  std::vector<std::pair<size_t, Stretches>> sets;
  for (const auto& [stretches, count] : triangles) sets.emplace_back(count, stretches);
  std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (sets.size() > kOwnSets) sets.resize(kOwnSets);
  std::vector<Stretches> own;
  for (auto& [count, stretches] : sets) own.push_back(std::move(stretches));
  return own;
}

size_t parts_per_span(UniformRun run, int keys) {
  const size_t spans = run.last - run.first, wanted = keys > 1 ? static_cast<size_t>(keys) - 1 : 1;
  return std::max<size_t>(1, std::min((wanted + spans - 1) / spans, (kMaxTimeSteps - 1) / spans));
}

}  // namespace kairos
