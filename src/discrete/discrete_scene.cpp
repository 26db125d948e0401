#include "discrete/discrete_scene.h"

#include <algorithm>
#include <cmath>

#include <kairos/error.h>

#include "discrete/discrete_impl.h"
#include "kernels/ray_frame.h"
#include "scene/instances.h"
#include "scene/working_scale.h"

namespace kairos {

InstructionSet embree_instruction_set(std::optional<InstructionSet> wanted) {
  const std::span<const InstructionSet> supported = supported_instruction_sets();
  const InstructionSet set = wanted.value_or(supported.back());
  if (std::find(supported.begin(), supported.end(), set) == supported.end())
    throw Error(ErrorCode::bad_usage, "instruction set " + std::string(to_string(set)),
                "this machine does not have it");
  // Of x86, every machine that Embree runs on has SSE4.
  return set == InstructionSet::scalar && supported.back() != InstructionSet::neon ? InstructionSet::sse4 : set;
}

DiscreteScene::DiscreteScene(std::span<const Mesh> meshes, const DiscreteOptions& options) {
  if (std::find(options.panes.begin(), options.panes.end(), true) != options.panes.end()) {
    std::vector<Mesh> only(meshes.size());
    for (size_t m = 0; m < meshes.size() && m < options.panes.size(); ++m)
      if (options.panes[m]) only[m] = meshes[m];
    DiscreteOptions alone = options;
    alone.panes.clear();
    panes_ = std::make_unique<const DiscreteScene>(only, alone);
  }
  const int exponent = working_exponent(meshes);
  if (exponent == 0) {
    impl_ = std::make_unique<Impl>(meshes, options);
    return;
  }
  validate_meshes(meshes);
  DiscreteOptions scaled = options;
  scaled.cut_outs = scaled_cut_outs(options.cut_outs, exponent);
  impl_ = std::make_unique<Impl>(scaled_copies(meshes, exponent), scaled);
  impl_->exponent = exponent;
}
DiscreteScene::~DiscreteScene() = default;
DiscreteScene::DiscreteScene(DiscreteScene&&) noexcept = default;
DiscreteScene& DiscreteScene::operator=(DiscreteScene&&) noexcept = default;

std::optional<DiscreteHit> DiscreteScene::intersect(const Ray& ray, float time, float max_dist, Facing facing) const {
  const ScaledRay scaled(ray, impl_->exponent);  // before denormals become zero
  const float scaled_max = std::ldexp(max_dist, scaled.exponent);
  std::optional<DiscreteHit> hit;
  {
    const DenormalsAreZero guard;
    hit = impl_->intersect(scaled.ray, time, scaled_max, facing);
  }
  if (hit) hit->dist = scaled.to_given(hit->dist);
  return hit;
}

void DiscreteScene::intersect(std::span<const Ray> rays, std::span<const float> times,
                              std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
  if (rays.size() != times.size() || rays.size() != hits.size())
    throw Error(ErrorCode::bad_usage, "DiscreteScene", "as many rays as times and hits are needed");
  if (impl_->exponent != 0 ||
      std::any_of(rays.begin(), rays.end(), [](const Ray& ray) { return ScaledRay(ray).exponent != 0; })) {
    std::vector<ScaledRay> scaled;
    std::vector<Ray> scaled_rays;
    for (const Ray& ray : rays) scaled_rays.push_back(scaled.emplace_back(ray, impl_->exponent).ray);
    impl_->intersect_all(scaled_rays, times, hits, layer);
    for (size_t i = 0; i < rays.size(); ++i)
      if (hits[i]) hits[i]->dist = scaled[i].to_given(hits[i]->dist);
    return;
  }
  impl_->intersect_all(rays, times, hits, layer);
}

bool DiscreteScene::occluded(const Ray& ray, float time, float max_dist, DiscreteLayer layer) const {
  const ScaledRay scaled(ray, impl_->exponent);  // before denormals become zero
  const float scaled_max = std::ldexp(max_dist, scaled.exponent);
  const DenormalsAreZero guard;
  return impl_->occluded(scaled.ray, time, scaled_max, layer);
}

void DiscreteScene::occluded(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                             std::span<bool> result, DiscreteLayer layer) const {
  if (rays.size() != times.size() || rays.size() != max_dists.size() || rays.size() != result.size())
    throw Error(ErrorCode::bad_usage, "DiscreteScene", "as many rays as times, distances and results are needed");
  if (impl_->exponent != 0 ||
      std::any_of(rays.begin(), rays.end(), [](const Ray& ray) { return ScaledRay(ray).exponent != 0; })) {
    for (size_t i = 0; i < rays.size(); ++i) result[i] = occluded(rays[i], times[i], max_dists[i], layer);
    return;
  }
  impl_->occluded_all(rays, times, max_dists, result, layer);
}

std::optional<DiscreteHit> DiscreteScene::intersect_panes(const Ray& ray, float time, float max_dist) const {
  return panes_ ? panes_->intersect(ray, time, max_dist, Facing::far_end) : std::nullopt;
}

const DiscreteStats& DiscreteScene::stats() const { return impl_->stats; }
size_t DiscreteScene::memory_bytes() const {
  size_t bytes = impl_->device.memory_bytes() + impl_->mesh_of.capacity() * sizeof(uint32_t);
  for (const auto& triangles : impl_->uneven) bytes += triangles->memory_bytes();
  for (const PlacedObject& object : impl_->placed) bytes += sizeof(object) + object.memory_bytes();
  return bytes + (panes_ ? panes_->memory_bytes() : 0);
}

}  // namespace kairos
