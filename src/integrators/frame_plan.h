// What is found out about the whole frame before its first pixel.
#pragma once

#include <optional>
#include <vector>

#include <kairos/render.h>

#include "policy/allotment.h"
#include "policy/packet_choice.h"
#include "policy/race.h"
#include "policy/sample_spread.h"
#include "shading/surface_cells.h"

namespace kairos {

/// From rays spread over the frame; the same for any crop. Kept by ShotParts for further crops and pictures.
struct FramePlan {
  PacketChoice packets;
  std::vector<bool> exact_shadows;    ///< [mesh]: where time-continuous rays find shadows exactly; empty: nowhere
  std::vector<bool> exact_mirrors;    ///< [mesh]: what they show is exact in time; empty: nowhere
  uint32_t still_rays_per_exact = 0;  ///< where nothing moves but shadows, see RestingPixels; 0: they are sampled
  std::optional<CellOptions> cells;   ///< by which light is shared; unset: it is not
  // Of the integrators mixed and auto.
  RayPrices prices;
  WorkSample work;                     ///< of a few rays
  Allotment allotment{1, {}};          ///< of the budget, where things move
  std::optional<Race> race;            ///< of lit pictures: decides in place of the allotment, where there was one
  std::optional<SampleSpread> spread;  ///< of pixels with discrete samples alone; unset: all get the budget
};

}  // namespace kairos
