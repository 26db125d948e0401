// What is expensive to make of a shot, and the same for many pictures of it.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include <kairos/render.h>
#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"
#include "motion/motion_mask.h"
#include "motion/screen_motion.h"
#include "shading/shader.h"

namespace kairos {

struct FramePlan;

/// Everything of a picture's parameters that a FramePlan depends on; so not its crop, channels or threads.
using PlanKey = std::tuple<IntegratorKind, int, int, Clusters, Shadows, Mirrors, Cells, int, SamplerKind, ShadingKind,
                           int, float, FilterKind, uint64_t, std::optional<InstructionSet>,
                           std::optional<std::array<double, 5>>, int, double, RecordNeeds::Time>;
PlanKey plan_key(const RenderParams& params, const RecordNeeds& needs);

/// Each part is made when it is first asked for. Reads the shot, which must outlive it. Not to be used from two threads
/// at once; what it hands out may be.
class ShotParts {
 public:
  explicit ShotParts(const Shot& shot);

  const Shot& shot() const { return shot_; }

  /// Of all discrete rays from now on.
  void choose_instruction_set(std::optional<InstructionSet> wanted);
  InstructionSet embree_set() const { return embree_set_; }
  /// discrete_keys: see RenderParams; of the rays that shading itself traces. want_variation: see Shader.
  const Shader& shader(ShadingKind kind, bool want_normal, int max_depth, int discrete_keys,
                       bool want_variation = false, float clamp = 0);
  /// moving_meshes_only: see TracerOptions; the same as without where nothing stands still.
  const Tracer& tracer(std::optional<InstructionSet> instruction_set, bool moving_meshes_only = false);
  const DiscreteScene& discrete(int keys);
  /// margin: see ScreenMotion. crop: the part of the frame that will be asked for; unset: all of it. Valid until
  /// another part or margin is asked for.
  const MotionMask& motion_mask(double margin, const std::optional<Crop>& crop);

  /// What was kept for pictures of these parameters; null for nothing.
  const FramePlan* find_plan(const PlanKey& key) const;
  /// Of the last few pictures of different parameters.
  void keep_plan(const PlanKey& key, const FramePlan& plan);

  /// The sum over what has been handed out since the last call, each counted once, of the time it took to make it, even
  /// if that was long ago.
  BuildSeconds take_build_seconds();

 private:
  /// A part and how long it took to make.
  template <class Part>
  struct Timed {
    std::shared_ptr<const Part> part;
    double seconds = 0;
  };
  template <class Part, class Make>
  const Part& use(Timed<Part>& timed, double BuildSeconds::*field, const Make& make);
  std::shared_ptr<const DiscreteScene> shared_discrete(int keys);
  void drop_discrete();
  std::shared_ptr<const CutOuts> cut_outs();

  const Shot& shot_;
  std::unique_ptr<const Shader> surfaces_;  // for its cut-outs
  std::map<std::tuple<ShadingKind, bool, int, bool, float>, Timed<Shader>> shaders_;
  std::map<std::pair<std::optional<InstructionSet>, bool>, Timed<Tracer>> tracers_;
  Timed<DiscreteScene> discrete_;
  int discrete_keys_ = 0;
  InstructionSet embree_set_ = embree_instruction_set(std::nullopt);
  std::map<double, Timed<ScreenMotion>> motions_;  // by margin
  /// Masks are made for whole squares of so many pixels, so that small crops next to each other share one.
  static constexpr int kMaskGrid = 256;
  Timed<MotionMask> mask_;
  double mask_margin_ = 0;
  std::deque<std::pair<PlanKey, std::shared_ptr<const FramePlan>>> plans_;
  BuildSeconds used_;
};

}  // namespace kairos
