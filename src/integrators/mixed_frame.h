// What mixed and auto know of the whole frame, and which rays each pixel gets by it.
#pragma once

#include <array>
#include <optional>

#include "discrete/discrete_scene.h"
#include "integrators/cell_tiles.h"
#include "integrators/frame_plan.h"
#include "integrators/integrator.h"
#include "motion/motion_mask.h"
#include "shading/exact_mirrors.h"
#include "shading/exact_shadows.h"
#include "shading/packet_shading.h"

namespace kairos {

/// Is changed only before the first pixel.
class MixedFrame {
 public:
  /// What is referred to has to outlive it.
  MixedFrame(ShotParts& parts, const RenderParams& params, const PixelContext& context);

  /// Traces a few rays all over the frame: sets the plan's packets, prices and allotment.
  void estimate();

  /// Pixels that something moves by while this one looks.
  double speed(int x, int y) const { return mask.speed(x, y) * static_cast<double>(context.times(x, y).duration()); }

  /// May a pixel get time-continuous rays? Who needs exact segments needs them everywhere.
  bool is_over_time(int x, int y) const {
    return context.needs.time == RecordNeeds::Time::segments || mask.moves(x, y);
  }

  /// For a pixel that may get time-continuous rays.
  PixelPlan plan_pixel(int x, int y) const;

  /// Pixels beside each other that are planned together, and those of them with `tc_rays` rays that may be traced
  /// together. Pixels with exposures of their own may look at different times.
  int strip() const { return context.exposure ? 1 : plan.packets.longest_strip(); }
  int strip(uint32_t tc_rays) const { return context.exposure ? 1 : plan.packets.strip(tc_rays); }

  /// How many time-continuous rays without the still layer's correction the budget is thought to buy.
  double raced_rays() const;

  const Shot& shot;
  const PixelContext& context;
  const RenderParams params;
  const bool automatic;        ///< plan per pixel
  const uint32_t budget;       ///< samples of a pixel
  const PixelPlan fixed_plan;  ///< where it is not automatic
  const Sampler share_points;
  const std::array<Sampler, 2> race_points;
  const ShadingOptions shading;
  const MotionMask& mask;
  const DiscreteScene& scene;
  const bool occluder_hints;  ///< are still rays traced first, as occluder hints?
  const Tracer& tracer;
  Surroundings surroundings;
  const bool still_layer_is_empty;  ///< but for a background that is the same everywhere
  const bool any_shows_others;      ///< see Shader::shows_others

  /// Of few samples of noisy light, races are to take less than they can win.
  bool races_thriftily() const { return is_lit(params.shading) && budget < kLeastForStill; }
  /// Of a pixel that gets any, about: before races.
  uint32_t tc_rays() const;

  /// As the plan says; to be called whenever it has changed.
  void use_shadows();
  void use_cells();  ///< the same
  /// Once it is known that light is shared: what rays cost then.
  void price_shared_light();
  /// Does the number of a pixel's samples depend on it? Where light is shared its noise is not the pixel's own.
  bool spreads() const { return spreads_samples(params) && !plan.cells; }
  /// In each pixel, about.
  double look_ups() const;
  /// Of the time-continuous rays of a pixel.
  ShadingOptions tc_shading() const;

  FramePlan plan;
  CellPlan cells;
  std::optional<ExactShadows> tc_shadows;       ///< unset: they are sampled
  std::optional<ExactShadows> resting_shadows;  ///< where nothing moves but shadows; unset: they are sampled
  std::optional<ExactMirrors> resting_mirrors;  ///< where nothing moves but what they show; unset: that is sampled
  double light_error = 0;                       ///< of shared light, with `budget` look-ups in a pixel; see CellChoice
  bool will_race = false;                       ///< until then any pixel may get time-continuous rays
};

}  // namespace kairos
