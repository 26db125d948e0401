#include "integrators/shot_parts.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "integrators/frame_plan.h"
#include "shading/shadow_rays.h"

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
                                bool want_variation, float clamp) {
  // Before the clock starts: this part has one of its own.
  const auto rays = is_lit(kind) ? shared_discrete(discrete_keys) : nullptr;
  return use(shaders_[{kind, want_normal, max_depth, want_variation, clamp}], &BuildSeconds::shading, [&] {
    return std::make_shared<const Shader>(shot_, kind, want_normal, max_depth, rays, want_variation, clamp);
  });
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

void ShotParts::choose_instruction_set(std::optional<InstructionSet> wanted) {
  const InstructionSet set = embree_instruction_set(wanted);
  if (set != embree_set_) drop_discrete();
  embree_set_ = set;
}

void ShotParts::drop_discrete() {
  discrete_ = {};
  std::erase_if(shaders_, [](const auto& entry) { return is_lit(std::get<0>(entry.first)); });
}

std::shared_ptr<const DiscreteScene> ShotParts::shared_discrete(int keys) {
  if (keys != discrete_keys_) drop_discrete();  // one is kept at a time: they are large
  discrete_keys_ = keys;
  const auto cut_outs = this->cut_outs();
  use(discrete_, &BuildSeconds::discrete, [&] {
    return std::make_shared<const DiscreteScene>(shot_.meshes,
                                                 DiscreteOptions{true, cut_outs, keys, panes_of(shot_), embree_set_});
  });
  return discrete_.part;
}

const DiscreteScene& ShotParts::discrete(int keys) { return *shared_discrete(keys); }

const MotionMask& ShotParts::motion_mask(double margin, const std::optional<Crop>& crop) {
  const Projection& frame = shot_.projection;
  const Crop asked = crop.value_or(Crop{0, frame.width, 0, frame.height});
  Timed<ScreenMotion>& motion = motions_[margin];
  use(motion, &BuildSeconds::motion_mask, [&] { return std::make_shared<const ScreenMotion>(shot_, margin); });
  const auto holds = [](const Crop& a, const Crop& b) {
    return a.x0 <= b.x0 && b.x1 <= a.x1 && a.y0 <= b.y0 && b.y1 <= a.y1;
  };
  if (margin != mask_margin_ || !mask_.part || !holds(mask_.part->part(), asked)) {
    mask_ = {};  // one is kept at a time: they may be large
    mask_margin_ = margin;
  }
  const auto before = [](int pixel) { return pixel / kMaskGrid * kMaskGrid; };
  const auto after = [&](int pixel, int end) { return std::min(before(pixel + kMaskGrid - 1), end); };
  const double motion_seconds = used_.motion_mask;
  const MotionMask& mask = use(mask_, &BuildSeconds::motion_mask, [&] {
    return std::make_shared<const MotionMask>(motion.part, Crop{before(asked.x0), after(asked.x1, frame.width),
                                                                before(asked.y0), after(asked.y1, frame.height)});
  });
  used_.motion_mask += motion_seconds;
  return mask;
}

PlanKey plan_key(const RenderParams& p, const RecordNeeds& needs) {
  static_assert(Calibration::kRays.size() == 3);
  std::optional<std::array<double, 5>> calibration;
  if (const auto& c = p.calibration)
    calibration = {c->discrete_sample, c->still_ray, c->tc_ray[0], c->tc_ray[1], c->tc_ray[2]};
  return {p.integrator, p.tc_rays, p.shading_samples, p.clusters,  p.shadows,       p.mirrors,
          p.cells,      p.spp,     p.sampler,         p.shading,   p.max_depth,     p.clamp,
          p.filter,     p.seed,    p.instruction_set, calibration, p.discrete_keys, p.shading_interval,
          needs.time};
}

const FramePlan* ShotParts::find_plan(const PlanKey& key) const {
  const auto at = std::find_if(plans_.begin(), plans_.end(), [&](const auto& entry) { return entry.first == key; });
  return at == plans_.end() ? nullptr : at->second.get();
}

void ShotParts::keep_plan(const PlanKey& key, const FramePlan& plan) {
  constexpr size_t kMostPlans = 16;
  if (plans_.size() == kMostPlans) plans_.pop_front();
  plans_.emplace_back(key, std::make_shared<const FramePlan>(plan));
}

BuildSeconds ShotParts::take_build_seconds() { return std::exchange(used_, {}); }

}  // namespace kairos
