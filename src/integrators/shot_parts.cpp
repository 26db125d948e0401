#include "integrators/shot_parts.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace kairos {

ShotParts::ShotParts(const Shot& shot) : shot_(shot) {}

template <class Part, class Make>
const Part& ShotParts::use(Timed<Part>& timed, double BuildSeconds::*field, const Make& make) {
  if (!timed.part) {
    const auto start = std::chrono::steady_clock::now();
    timed.part = make();
    timed.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  used_.*field = timed.seconds;
  return *timed.part;
}

const Shader& ShotParts::shader(ShadingKind kind, bool want_normal, int max_depth, int discrete_keys,
                                bool want_variation) {
  // Before the clock starts: this part has one of its own.
  const auto rays = kind == ShadingKind::whitted ? shared_discrete(discrete_keys) : nullptr;
  return use(shaders_[{kind, want_normal, max_depth, want_variation}], &BuildSeconds::shading,
             [&] { return std::make_shared<const Shader>(shot_, kind, want_normal, max_depth, rays, want_variation); });
}

const Tracer& ShotParts::tracer(std::optional<InstructionSet> instruction_set, bool moving_meshes_only) {
  const auto cut_outs = this->cut_outs();
  const auto stands_still = [](const Mesh& mesh) { return mesh.is_static(); };
  if (std::none_of(shot_.meshes.begin(), shot_.meshes.end(), stands_still)) moving_meshes_only = false;
  return use(tracers_[{instruction_set, moving_meshes_only}], &BuildSeconds::tracer, [&] {
    return std::make_shared<const Tracer>(
        shot_.meshes, TracerOptions{Precision::fast, instruction_set, cut_outs, moving_meshes_only});
  });
}

std::shared_ptr<const CutOuts> ShotParts::cut_outs() {
  if (!surfaces_) surfaces_ = std::make_unique<const Shader>(shot_, ShadingKind::flat, false);
  return surfaces_->cut_outs();
}

std::shared_ptr<const DiscreteScene> ShotParts::shared_discrete(int keys) {
  if (keys != discrete_keys_) {  // one is kept at a time: they are large
    discrete_ = {};
    std::erase_if(shaders_, [](const auto& entry) { return std::get<0>(entry.first) == ShadingKind::whitted; });
    discrete_keys_ = keys;
  }
  const auto cut_outs = this->cut_outs();
  use(discrete_, &BuildSeconds::discrete, [&] {
    return std::make_shared<const DiscreteScene>(shot_.meshes, DiscreteOptions{true, cut_outs, keys});
  });
  return discrete_.part;
}

const DiscreteScene& ShotParts::discrete(int keys) { return *shared_discrete(keys); }

const MotionMask& ShotParts::motion_mask(double margin) {
  return use(masks_[margin], &BuildSeconds::motion_mask,
             [&] { return std::make_shared<const MotionMask>(shot_, margin); });
}

BuildSeconds ShotParts::take_build_seconds() { return std::exchange(used_, {}); }

}  // namespace kairos
